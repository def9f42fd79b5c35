"""The sample of a motion that each frame of an animation shows.

A student may round indices down, repeat or skip samples, or resample to real time. So the time of a frame is
free by ``SLACK`` samples about a law (an even run from one sample to another, or the frame values read as
indices or as times), but it never runs back. At these times the comparison with the exact curve is strict.

Times are counted in samples of the motion; a ``basis`` (G, e, m) holds m functions of time for e equations on
a grid of ``PER`` points a sample, and ``drawn`` (f, e, v) v paths in f frames: drawn ≈ basis · coefficients
at the time of each frame.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int_]

PER = 8  # a sixteenth of a sample is the largest error of a time on the grid: under 1 % of any path here
SLACK = 1.5  # samples: one for rounding and repeating, half for the spacing of the laws
HELD = 0.25  # share of the frames that may hold the end, if the frames before do not advance by one sample each
LEAST_FRAMES = 10
FALLING = 0.25  # share of the frames at which time runs back: more than in a motion that begins again
FAST = 1.3  # times the speed of an even run
SPARSE = 48  # frames that decide between laws, before all frames are compared
WORST = 4.0  # times the misfit of all frames: the largest misfit of a single frame


class Fit(NamedTuple):
    """A fit of all paths: ``times`` (f,) in samples, ``coefficients`` (m, v).

    ``misfit`` (v,) is the root mean square over frames and equations, ``worst`` (v,) the largest of one
    frame.
    """

    times: Array
    grid: Indices
    coefficients: Array
    misfit: Array
    worst: Array

    def within(self, limit: Array) -> Array:
        """Return which paths (v,) stay within ``limit`` (v,), in all and, WORST times as far, in each frame."""
        return np.asarray((self.misfit <= limit) & (self.worst <= WORST * limit))


def laws(at: Array, t: Array, turned: Array) -> Array:
    """Return sample numbers (k, f) that the followed frames may show: all of the motion, or a part of at
    least one full turn.

    ``at`` (f, 3): number and value of each frame, and the number of frames; ``t`` (n,); ``turned`` (n,):
    turns since the start.
    """
    number, value, total = at[:, 0], at[:, 1], at[0, 2]
    n = len(t)
    last, part = n - 1, np.arange(n)
    first_turn = np.searchsorted(turned, min(1.0, turned[-1]) - 1e-9)
    fractions = [number / max(total - 1, 1)]
    indices = [number]
    if np.all(value >= 0) and value[-1] > value[0] and np.all(np.diff(value) >= 0):
        if _even(value) or _even(np.interp(value, part, t)):
            fractions.append((value - value[0]) / (value[-1] - value[0]))
            indices += [value, np.interp(value, t, part)]
    elif np.all(value >= 0) and _begins_again(value):
        indices.append(value)
    ends = np.arange(last if _one_frame_each(total, n) else first_turn, last / (1 - HELD))
    found = [end * x for x in fractions for end in ends]
    for index in indices:
        found += [np.minimum(index, last), index % n]
    for stride in range(1, 1 + int(last / max(total - 1, 1))):
        reach = stride * (total - 1)
        found += [start + stride * number for start in part if start + reach <= last]
    found = np.clip(np.array(found), 0, last)
    start, end = found.min(axis=1), found.max(axis=1)
    turns = np.interp(end + SLACK, part, turned) - np.interp(start - SLACK, part, turned)
    return found[turns >= min(1.0, turned[-1])]


def _one_frame_each(total: float, n: int) -> bool:
    """Return whether there are as many frames as samples: frame k then shows sample k."""
    return abs(total - n) < 0.5


def _even(value: Array) -> bool:
    """Return whether rising values (f,) run evenly up to one step or SLACK samples, until they hold their
    last one.
    """
    moving = value[: int(np.argmax(value >= value[-1])) + 1]
    line = np.linspace(moving[0], moving[-1], len(moving))
    return bool(
        np.abs(moving - line).max() <= max(float(np.median(np.diff(moving))), SLACK if np.all(value == np.rint(value)) else 0.0)
    )


def _begins_again(value: Array) -> bool:
    """Return whether frame values (f,) rise from the first to the last, and then again from the first: they
    never count down.
    """
    steps = np.diff(value)
    falls, reach = steps < 0, 2 * steps.max(initial=0.0)
    low, high = value.min() + reach, value.max() - reach
    return bool(np.any(steps > 0) and np.all(value[1:][falls] <= low) and np.all(value[:-1][falls] >= high) and low < high)


def sparse(frames: int) -> Indices:
    """Return at most SPARSE of ``frames``, evenly spread."""
    return np.unique(np.rint(np.linspace(0, frames - 1, min(SPARSE, frames))).astype(int))


def screened(basis: Array, drawn: Array, laws: Array) -> Array:
    """Return for each law the root mean square residual (k, v) of each path in SPARSE frames, at the unfitted
    times of the law.
    """
    few = sparse(len(drawn))
    laws, drawn = laws[:, few], drawn[few]
    e, m, v = *basis.shape[1:], drawn.shape[2]
    design = basis[on_grid(laws, len(basis))].reshape(len(laws), -1, m)
    values = drawn.reshape(-1, v)
    products = np.swapaxes(design, 1, 2)
    normal = products @ design
    normal += 1e-10 * np.trace(normal, axis1=1, axis2=2)[:, None, None] * np.eye(m)
    right = products @ values
    left = np.sum(values**2, axis=0) - np.sum(np.linalg.solve(normal, right) * right, axis=1)
    return np.asarray(np.sqrt(np.maximum(left, 0) / (len(drawn) * e)))


def found(basis: Array, drawn: Array, law: Array, limit: float) -> Fit | None:
    """Return the fit of all paths together if it stays within ``limit``, first in a few frames and then in
    all; else None.
    """
    few = sparse(len(drawn))
    whole = None
    for part in (few, np.arange(len(drawn))) if len(few) < len(drawn) else (few,):
        fit = fitted(basis, drawn[part], law[part])
        whole = fit._replace(misfit=np.array([np.linalg.norm(fit.misfit)]), worst=np.array([np.linalg.norm(fit.worst)]))
        if not whole.within(np.array([limit])).all():
            return None
    return whole


def fitted(basis: Array, drawn: Array, law: Array) -> Fit:
    """Fit times within SLACK of the law, in order, and coefficients in turn until neither changes."""
    if law[-1] < law[0]:
        back = fitted(basis, drawn[::-1], law[::-1])
        return back._replace(times=back.times[::-1], grid=back.grid[::-1])
    near = choices(law, len(basis))
    grid = on_grid(law, len(basis))
    for _ in range(8):
        coefficients = coefficients_at(basis, drawn, grid)
        curve = basis @ coefficients
        costs = np.sum((drawn[:, None] - curve[near]) ** 2, axis=(2, 3))
        chosen = in_order(costs, near, law)
        if np.array_equal(chosen, grid):
            break
        grid = chosen
    coefficients = coefficients_at(basis, drawn, grid)
    left = drawn - basis[grid] @ coefficients
    return Fit(grid / PER, grid, coefficients, *misfits(left))


def misfits(left: Array) -> tuple[Array, Array]:
    """Return the root mean square (v,) of the residuals ``left`` (f, e, v), over all frames and in the worst
    of them.
    """
    each = np.mean(left**2, axis=1)
    return np.sqrt(np.mean(each, axis=0)), np.sqrt(np.max(each, axis=0))


def coefficients_at(basis: Array, drawn: Array, grid: Indices) -> Array:
    """Return coefficients (m, v) by least squares if each frame's time is the given place on the grid."""
    design = basis[grid].reshape(-1, basis.shape[2])
    return np.asarray(np.linalg.lstsq(design, drawn.reshape(-1, drawn.shape[2]), rcond=None)[0])


def spread(drawn: Array) -> Array:
    """Return the root mean square (v,) of each path about its mean, over frames and equations."""
    return np.asarray(np.sqrt(np.mean((drawn - drawn.mean(axis=0)) ** 2, axis=(0, 1))))


def choices(law: Array, size: int) -> Indices:
    """Return places (f, c) on the grid within SLACK of the law (f,)."""
    half = int(SLACK * PER)
    return np.asarray(np.clip(on_grid(law, size)[:, None] + np.arange(-half, half + 1), 0, size - 1))


def on_grid(times: Array, size: int) -> Indices:
    """Return the nearest places on the grid of ``size`` points."""
    return np.clip(np.rint(times * PER).astype(int), 0, size - 1)


def in_order(costs: Array, choices: Indices, law: Array) -> Indices:
    """Return the cheapest choice for each frame with times that never run back unless the law (f,) begins
    again; costs (f, c).
    """
    restarts = np.concatenate([[True], np.diff(law) < 0])
    total, came = costs[0], []
    for k in range(1, len(costs)):
        if restarts[k]:
            before = np.full(costs.shape[1], int(np.argmin(total)))
        else:
            least = np.minimum.accumulate(total)
            at = np.maximum.accumulate(np.where(total <= least, np.arange(len(total)), 0))
            place = np.searchsorted(choices[k - 1], choices[k], side="right") - 1
            before = np.where(place >= 0, at[np.maximum(place, 0)], -1)
        total = costs[k] + np.where(before >= 0, total[before], np.inf)
        came.append(before)
    chosen = [int(np.argmin(total))]
    for before in reversed(came):
        chosen.append(int(before[chosen[-1]]))
    return choices[np.arange(len(choices)), chosen[::-1]]


def wrong_laws(at: Array, n: int) -> Array:
    """Return sample numbers (k, f) of usual mistakes: too short a part, a part or all of it repeated, another
    speed.
    """
    number, value, total = at[:, 0], at[:, 1], at[0, 2]
    last, shift = n - 1, int(2 * SLACK) + 1
    found = [end * number / max(total - 1, 1) for end in range(1, n)]
    found += [np.minimum(end * number / max(total - 1, 1), last) for end in range(n, 6 * n)]
    indices = [number, value] if np.all(value >= 0) and np.ptp(value) > 0 and np.all(value == np.rint(value)) else [number]
    for index in indices:
        found.append(index)
        found += [index % part for part in range(2, n)]
        found += [(speed * index) % n for speed in (0.5, 2, 3, 4, 5)]
        found += [start + index * 1.0 for start in range(shift, n)]
        found += [(start + index) % n for start in range(shift, n - shift)]
    return np.clip(np.array(found), 0, last)


def describe(times: Array, at: Array, n: int) -> str:
    """Return what is wrong with the ``times`` (f,) of the followed frames, for a report."""
    number, total = at[:, 0], int(at[0, 2])
    low, high = times.min(), times.max()
    back = np.diff(times) < 0
    if back.mean() > FALLING:
        return f"the animation runs backwards from frame {number[int(np.argmax(back))]:.0f} of {total} on: show it forwards only"
    if high - low < n / 2:
        again = " repeatedly" if np.any(np.diff(times) < -SLACK) else ""
        return f"the animation shows only samples {low:.0f}–{high:.0f} of {n}{again}: show the whole motion"
    if np.any(np.diff(times) < -SLACK):
        k = int(np.argmax(np.diff(times) < -SLACK))
        speed = (times[k] - times[0]) / max(number[k] - number[0], 1) * (total - 1) / (n - 1)
        fast = f" runs {'twice' if round(speed, 1) == 2 else f'{speed:.2g} times'} as fast and" if speed > FAST else ""
        again = f"the animation{fast} begins again after frame {number[k]:.0f} of {total}"
        return f"{again}: show the motion once, from its start to its end"
    first = int(np.argmax(times >= high - 0.5))
    if number[first] < (1 - HELD) * (total - 1):
        early = f"frame {number[first]:.0f} of {total} already shows sample {high:.0f} of {n}"
        return f"{early}, and later frames do not change: spread the samples over all frames"
    if high - low >= n - 1 - 2 * SLACK or _one_frame_each(total, n):
        k = int(np.argmax(np.abs(times - (n - 1) * number / max(total - 1, 1))))
        return f"its samples are mistimed: frame {number[k]:.0f} of {total} shows sample {times[k]:.0f} of {n}"
    return f"the animation shows only samples {low:.0f}–{high:.0f} of {n}, less than a full turn: show the whole motion"
