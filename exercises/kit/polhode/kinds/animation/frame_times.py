"""The sample of a motion that each frame of an animation shows.

A student may round indices down, repeat or skip samples, or resample to real time. So the time of a frame is
free by ``SLACK`` samples about a law (an even run from one sample to another, or the frame values read as
indices or as times), but it never runs back. The first and the last picture may rest for a while before and
after. At these times the comparison with the exact curve is strict.

Times are counted in samples of the motion; a ``basis`` (G, e, m) holds m functions of time for e equations on
a grid of ``PER`` points a sample, and ``drawn`` (f, e, v) v paths in f frames: drawn ≈ basis · coefficients
at the time of each frame.
"""

from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int_]

PER = 8  # a sixteenth of a sample is the largest error of a time on the grid: under 1 % of any path here
SLACK = 1.5  # samples: one for rounding and repeating, half for the spacing of the laws
# share of the frames that may hold the start, and the end, if the frames between do not advance by one sample
# each
HELD = 0.25
LEAST_FRAMES = 10
FALLING = 0.25  # share of the frames at which time runs back: more than in a motion that begins again
FAST = 1.3  # times the speed of an even run
SPARSE = 48  # frames that decide between laws, before all frames are compared
WORST = 4.0  # times the misfit of all frames: the largest misfit of a single frame


class Frames:
    """The frames of an animation of n samples at times ``t`` (n,): number and value of each, and their total,
    in ``at`` (f, 3).

    ``turned`` (n,) are the turns of the motion since its start. ``rests`` are the numbers of frames that only
    repeat the picture of the first frame, and that of the last.
    """

    def __init__(self, at: Array, t: Array, turned: Array, rests: tuple[int, int] = (0, 0)) -> None:
        self.at, self.t, self.turned, self.n, self.rests = at, t, turned, len(t), rests
        self.number, self.value, self.total = at[:, 0], at[:, 1], at[0, 2]
        self.fraction = self.number / max(self.total - 1, 1)
        self.one_each = abs(self.total - self.n) < 0.5  # frame k then shows sample k

    @cached_property
    def laws(self) -> Array:
        """The sample numbers (k, f) that the frames may show: of all the motion, or a part of at least one
        full turn, with rests before and after.
        """
        first, last = (self._may_rest(*rest) for rest in zip(self.rests, (1, -1), strict=True))
        if first + last < SLACK:
            return self._moving_laws()
        moving = self.at[first : len(self.at) - last].copy()
        moving[:, 2] = 1 + moving[-1, 0] - moving[0, 0]
        moving[:, 0] -= moving[0, 0]
        between = Frames(moving, self.t, self.turned)._moving_laws()
        return np.concatenate([self._moving_laws(), np.pad(between, ((0, 0), (first, last)), "edge")])

    def _may_rest(self, frames: int, step: int) -> int:
        """Return the number of ``frames`` at the start (``step`` 1) or the end (−1) that are a rest: any with
        the same value, a few with others, and none of unknown or other values if there is one for each
        sample.
        """
        value = self.value[::step][: frames + 1]
        repeated, known = bool(np.all(value == value[0])), value[0] >= 0
        few = frames <= HELD * (len(self.at) - 1)
        return frames if (repeated and known) or ((repeated or few) and not self.one_each) else 0

    def _moving_laws(self) -> Array:
        value, turned, last, part = self.value, self.turned, self.n - 1, np.arange(self.n)
        fractions, indices = [self.fraction], [self.number]
        if np.all(value >= 0) and value[-1] > value[0] and np.all(np.diff(value) >= 0):
            if _even(value) or _even(np.interp(value, part, self.t)):
                fractions.append((value - value[0]) / (value[-1] - value[0]))
                indices += [value, np.interp(value, self.t, part)]
        elif np.all(value >= 0) and _begins_again(value):
            indices.append(value)
        first_turn = np.searchsorted(turned, min(1.0, turned[-1]) - 1e-9)
        found = [
            end * x
            for x in fractions
            for end in np.arange(last if self.one_each else first_turn, last / (1 - HELD))
        ]
        found += [law for index in indices for law in (np.minimum(index, last), index % self.n)]
        for stride in range(1, 1 + int(last / max(self.total - 1, 1))):
            found += [
                start + stride * self.number for start in part if start + stride * (self.total - 1) <= last
            ]
        laws = np.clip(np.array(found), 0, last)
        low, high = laws.min(axis=1) - SLACK, laws.max(axis=1) + SLACK
        return laws[np.interp(high, part, turned) - np.interp(low, part, turned) >= min(1.0, turned[-1])]

    @cached_property
    def late(self) -> Array:
        """The sample numbers (k, f) of usual mistakes: too short a part, a part or all of it repeated,
        another speed.
        """
        value, n, shift = self.value, self.n, int(2 * SLACK) + 1
        found = [end * self.fraction for end in range(1, n)]
        found += [np.minimum(end * self.fraction, n - 1) for end in range(n, 6 * n)]
        whole = np.all(value >= 0) and np.ptp(value) > 0 and np.all(value == np.rint(value))
        for index in (self.number, value) if whole else (self.number,):
            found += [
                index,
                *(index % part for part in range(2, n)),
                *((speed * index) % n for speed in (0.5, 2, 3, 4, 5)),
            ]
            found += [start + index for start in range(shift, n)]
            found += [(start + index) % n for start in range(shift, n - shift)]
        return np.clip(np.array(found), 0, n - 1)

    def covered(self, times: Array) -> str:
        """Return which samples the ``times`` (f,) cover, for a report."""
        n, low, high = self.n, times.min(), times.max()
        step = max(SLACK, float(np.diff(np.sort(times)).max()) + 0.5)
        return (
            f"all {n} samples"
            if low <= step and high >= n - 1 - step
            else f"samples {low:.0f}–{high:.0f} of {n}"
        )

    def wrong(self, times: Array) -> str:
        """Return what is wrong with the ``times`` (f,) of the followed frames, for a report."""
        number, total, n, low, high = self.number, int(self.total), self.n, times.min(), times.max()
        back, again = np.diff(times) < 0, np.diff(times) < -SLACK
        if back.mean() > FALLING:
            k = int(np.argmax(back))
            return (
                f"the animation runs backwards from frame {number[k]:.0f} of {total} on: show it forwards"
                " only"
            )
        if high - low < n / 2:
            repeatedly = " repeatedly" if again.any() else ""
            return (
                f"the animation shows only samples {low:.0f}–{high:.0f} of {n}{repeatedly}: show the whole"
                " motion"
            )
        if again.any():
            k = int(np.argmax(again))
            speed = (times[k] - times[0]) / max(number[k] - number[0], 1) * (total - 1) / (n - 1)
            fast = (
                f" runs {'twice' if round(speed, 1) == 2 else f'{speed:.2g} times'} as fast and"
                if speed > FAST
                else ""
            )
            restart = f"the animation{fast} begins again after frame {number[k]:.0f} of {total}"
            return f"{restart}: show the motion once, from its start to its end"
        first = int(np.argmax(times >= high - 0.5))
        if number[first] < (1 - HELD) * (total - 1):
            early = f"frame {number[first]:.0f} of {total} already shows sample {high:.0f} of {n}"
            return f"{early}, and later frames do not change: spread the samples over all frames"
        if high - low >= n - 1 - 2 * SLACK or self.one_each:
            k = int(np.argmax(np.abs(times - (n - 1) * self.fraction)))
            return (
                f"its samples are mistimed: frame {number[k]:.0f} of {total} shows sample {times[k]:.0f}"
                f" of {n}"
            )
        return (
            f"the animation shows only samples {low:.0f}–{high:.0f} of {n}, less than a full turn: show the"
            " whole motion"
        )


def _even(value: Array) -> bool:
    """Return whether rising values (f,) run evenly up to one step or SLACK samples, until they hold their
    last one.
    """
    moving = value[: int(np.argmax(value >= value[-1])) + 1]
    off = np.abs(moving - np.linspace(moving[0], moving[-1], len(moving))).max()
    return bool(
        off <= max(float(np.median(np.diff(moving))), SLACK if np.all(value == np.rint(value)) else 0.0)
    )


def _begins_again(value: Array) -> bool:
    """Return whether frame values (f,) rise from the first to the last, and then again from the first: they
    never count down.
    """
    steps = np.diff(value)
    falls, reach = steps < 0, 2 * steps.max(initial=0.0)
    low, high = value.min() + reach, value.max() - reach
    return bool(
        np.any(steps > 0)
        and np.all(value[1:][falls] <= low)
        and np.all(value[:-1][falls] >= high)
        and low < high
    )


class Fit(NamedTuple):
    """A fit of paths: ``times`` (f,) in samples and on the ``grid``, within SLACK of ``law`` (f,), and
    ``coefficients`` (m, v).

    ``misfit`` is that of all paths together, as of ``misfits``.
    """

    times: Array
    grid: Indices
    coefficients: Array
    misfit: float
    law: Array


def found(basis: Array, drawn: Array, law: Array, limit: float) -> Fit | None:
    """Return the fit of all paths together if its misfit is at most ``limit`` of their spread, in a few
    frames and in all.
    """
    whole = limit * np.sqrt(np.mean(spread(drawn) ** 2))
    for part in (sparse(len(drawn)), np.arange(len(drawn))):
        fit = fitted(basis, drawn[part], law[part])
        if fit.misfit > whole:
            return None
    return fit


def fitted(basis: Array, drawn: Array, law: Array) -> Fit:
    """Fit times within SLACK of the law, in order, and coefficients in turn until neither changes."""
    near, grid = choices(law, len(basis)), on_grid(law, len(basis))
    for _ in range(8):
        curve = basis @ coefficients_at(basis, drawn, grid)
        chosen = in_order(np.sum((drawn[:, None] - curve[near]) ** 2, axis=(2, 3)), near, law)
        if np.array_equal(chosen, grid):
            break
        grid = chosen
    coefficients = coefficients_at(basis, drawn, grid)
    left = drawn - basis[grid] @ coefficients
    return Fit(grid / PER, grid, coefficients, float(misfits(left.reshape(len(left), -1, 1))[0]), law)


def screened(basis: Array, drawn: Array, laws: Array) -> Array:
    """Return the root mean square residual (k, v) of each path in SPARSE frames, at the unfitted times of
    each law.
    """
    few = sparse(len(drawn))
    design = basis[on_grid(laws[:, few], len(basis))].reshape(len(laws), -1, basis.shape[2])
    values, products = drawn[few].reshape(-1, drawn.shape[2]), np.swapaxes(design, 1, 2)
    normal, right = products @ design, products @ values
    normal += 1e-10 * np.trace(normal, axis1=1, axis2=2)[:, None, None] * np.eye(basis.shape[2])
    left = np.sum(values**2, axis=0) - np.sum(np.linalg.solve(normal, right) * right, axis=1)
    return np.asarray(np.sqrt(np.maximum(left, 0) / len(values)))


def misfits(left: Array) -> Array:
    """Return the root mean square (v,) of the residuals ``left`` (f, e, v), or WORST of that in one frame if
    this is more.
    """
    each = np.mean(left**2, axis=1)
    return np.sqrt(np.maximum(np.mean(each, axis=0), np.max(each, axis=0) / WORST**2))


def spread(drawn: Array) -> Array:
    """Return the root mean square (v,) of each path about its mean, over frames and equations."""
    return np.asarray(np.sqrt(np.mean((drawn - drawn.mean(axis=0)) ** 2, axis=(0, 1))))


def coefficients_at(basis: Array, drawn: Array, grid: Indices) -> Array:
    """Return coefficients (m, v) by least squares if each frame's time is the given place on the grid."""
    return np.asarray(
        np.linalg.lstsq(
            basis[grid].reshape(-1, basis.shape[2]), drawn.reshape(-1, drawn.shape[2]), rcond=None
        )[0]
    )


def sparse(frames: int, number: int = SPARSE) -> Indices:
    """Return at most ``number`` of the frames, evenly spread."""
    return np.unique(np.rint(np.linspace(0, frames - 1, min(number, frames))).astype(int))


def on_grid(times: Array, size: int) -> Indices:
    """Return the nearest places on the grid of ``size`` points."""
    return np.clip(np.rint(times * PER).astype(int), 0, size - 1)


def choices(law: Array, size: int) -> Indices:
    """Return places (f, c) on the grid within SLACK of the law (f,)."""
    return np.asarray(
        np.clip(on_grid(law, size)[:, None] + np.arange(-int(SLACK * PER), int(SLACK * PER) + 1), 0, size - 1)
    )


def in_order(costs: Array, choices: Indices, law: Array) -> Indices:
    """Return the cheapest choice for each frame, with times that run back only where the law (f,) does; costs
    (f, c).
    """
    total, came = costs[0], []
    for k in range(1, len(costs)):
        best = np.maximum.accumulate(
            np.where(total <= np.minimum.accumulate(total), np.arange(len(total)), 0)
        )
        place = np.searchsorted(choices[k - 1], choices[k], side="right") - 1
        if law[k] < law[k - 1]:
            place[:] = len(total) - 1
        total = costs[k] + np.where(place >= 0, total[best[place]], np.inf)
        came.append(best[place])
    chosen = [int(np.argmin(total))]
    for before in reversed(came):
        chosen.append(int(before[chosen[-1]]))
    return choices[np.arange(len(choices)), chosen[::-1]]
