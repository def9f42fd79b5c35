"""Where methods fail: six pictures of an error, each with sentences whose numbers and truth follow from it.

Every picture has the error of ω (relative to |ω₀|) or of R (largest element) against the exact motion.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from reference.charts.deviations import errors
from reference.charts.scenes import EXERCISE_2, EXERCISE_6, TOP, nudged
from reference.exact import Exact
from reference.methods import METHODS
from reference.methods.method import Scene
from reference.methods.runge_kutta import RK4, STEPS, adaptive, fixed
from reference.methods.states import ANGLES, MATRIX, QUATERNION
from reference.stability import sensitivity

BY_NAME = {method.name: method for method in METHODS}
FORMS = {"Euler angles": ANGLES, "matrix": MATRIX, "quaternion": QUATERNION}
EPSILON, EPSILON_SINGLE = 2.0**-52, 2.0**-23
PERIOD = Exact(EXERCISE_2.w0, EXERCISE_2.I).period


class Curve(NamedTuple):
    """A named curve of a picture; ``y`` is infinite where a run diverges."""

    name: str
    x: list[float]
    y: list[float]


class Claim(NamedTuple):
    """A sentence with measured numbers, and whether they support it."""

    sentence: str
    holds: bool


Curves = Mapping[str, Curve]


@dataclass(frozen=True)
class Picture:
    """One picture: its title, the names of its axes, the curves, and the claims that follow from them."""

    title: str
    across: str
    up: str
    measure: Callable[[], Iterator[Curve]]
    claims: Callable[[Curves], Iterator[Claim]]


def _long(periods: tuple[int, ...] = (10, 30, 100, 300, 1000)) -> Iterator[Curve]:
    for name in ("RK4", "splitting 6"):
        scenes = [replace(EXERCISE_2, t_end=count * PERIOD, intervals=10 * count) for count in periods]
        found = [errors(scene, BY_NAME[name].run(scene, 18)) for scene in scenes]
        yield Curve(f"{name}, ω", [*map(float, periods)], [e.w for e in found])
        yield Curve(f"{name}, energy", [*map(float, periods)], [e.energy for e in found])


def _long_claims(of: Curves) -> Iterator[Claim]:
    rk, rk_w, kept, kept_w = (
        of[n].y for n in ("RK4, energy", "RK4, ω", "splitting 6, energy", "splitting 6, ω")
    )
    runs = f"from {of['RK4, ω'].x[0]:g} to {of['RK4, ω'].x[-1]:g} periods, 180 steps each"
    yield Claim(
        f"RK4 loses energy in proportion to time, and the phase faster than that: {runs}, the energy error"
        f" grows ×{rk[-1] / rk[0]:.0f} and that of ω ×{rk_w[-1] / rk_w[0]:.0f}, to {rk_w[-1]:.1g}.",
        80 < rk[-1] / rk[0] < 125 and rk_w[-1] > 5 * 100 * rk_w[0],
    )
    yield Claim(
        f"Splitting 6 keeps the energy to {max(kept):.1g} at any length, but its ω error still grows"
        f" ×{kept_w[-1] / kept_w[0]:.0f}, to {kept_w[-1]:.1g}: a conserved energy is no proof of a right"
        " motion.",
        max(kept) < 2 * min(kept) and 50 < kept_w[-1] / kept_w[0] < 200,
    )


def _large(angles: tuple[float, ...] = (0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 4.0)) -> Iterator[Curve]:
    turned = 100 / float(np.linalg.norm(EXERCISE_2.w0))
    scenes = [replace(EXERCISE_2, t_end=turned, intervals=round(100 / angle)) for angle in angles]
    for method in METHODS:
        if method.order is not None:
            yield Curve(method.name, [*angles], [errors(s, method.run(s, 1)).w for s in scenes])


def _large_claims(of: Curves) -> Iterator[Claim]:
    at = [dict(zip(curve.x, curve.y, strict=True)) for curve in of.values()]
    names, small = [*of], [error[0.1] for error in at]
    usable = [name for name, error in zip(names, at, strict=True) if error[1.0] < 1e-2]
    yield Claim(
        f"At 0.1 rad a step the order decides: {max(small):.1g} ({names[int(np.argmax(small))]}) to"
        f" {min(small):.1g} ({names[int(np.argmin(small))]}).",
        max(small) > 0.1 and min(small) < 1e-12,
    )
    yield Claim(
        f"At 1 rad a step {', '.join(usable)} still have an error below 1 %; Strang splitting conserves |L|"
        f" exactly and is wrong by {of['Strang splitting'].y[4]:.1g}; Euler's method diverges.",
        set(usable) == {"RK4", "RK8", "splitting 6"}
        and of["Strang splitting"].y[4] > 1
        and math.isinf(at[names.index("Euler")][1.0]),
    )
    best = min(error[4.0] for error in at)
    yield Claim(f"At 4 rad a step all fail: the best error is {best:.1g}.", best > 1e-3)


def _tilts(tilts: tuple[float, ...] = (1.0, 1e-1, 1e-2, 1e-3, 1e-4)) -> Iterator[Curve]:
    scenes = [replace(EXERCISE_6, tilt=tilt) for tilt in tilts]
    for name, form in FORMS.items():
        yield Curve(name, [*tilts], [errors(s, fixed(RK4, s, 10, form)).R for s in scenes])


def _tilts_claims(of: Curves) -> Iterator[Claim]:
    angles, matrix, quaternion = (of[name].y for name in FORMS)
    yield Claim(
        f"RK4 with 400 equal steps: Euler angles fail as the body nears the vertical, where φ and ψ turn"
        f" about one axis: {angles[0]:.1g} at {of['matrix'].x[0]:g} rad, {angles[-1]:.1g} at"
        f" {of['matrix'].x[-1]:g} rad.",
        angles[0] < 1e-6 and angles[-1] > 1e-2,
    )
    yield Claim(
        f"Matrix and quaternion do not fail at any tilt ({max(matrix):.1g} and {max(quaternion):.1g}); the"
        f" quaternion is {min(matrix) / max(quaternion):.0f} times as accurate, with 7 numbers for 12.",
        max(matrix) < 1.1 * min(matrix) and max(quaternion) < 1.2 * min(quaternion) < min(matrix) / 5,
    )


def _forms() -> Iterator[Curve]:
    scene = replace(EXERCISE_2, t_end=10 * PERIOD, intervals=100, tilt=1.0)
    runs = {name: fixed(RK4, scene, 18, form) for name, form in FORMS.items()}
    runs["orthonormal again"] = fixed(RK4, scene, 18, tidy=True)
    for name, run in runs.items():
        found = errors(scene, run)
        yield Curve(name, [found.orthonormality], [found.R])


def _forms_claims(of: Curves) -> Iterator[Claim]:
    plain, tidied, quaternion = (of[n] for n in ("matrix", "orthonormal again", "quaternion"))
    yield Claim(
        f"RK4, 10 periods: making R orthonormal again after each step lowers |RᵀR − 1| from"
        f" {plain.x[0]:.1g} to {tidied.x[0]:.1g} and leaves the error of R at {tidied.y[0]:.2g}, before"
        f" {plain.y[0]:.2g}: an orthonormal R is no proof of a right one.",
        plain.x[0] > 1e-5 and tidied.x[0] < 1e-12 and 0.9 < tidied.y[0] / plain.y[0] < 1.1,
    )
    yield Claim(
        f"The quaternion has {quaternion.y[0]:.1g}. Euler angles always make a rotation, here one that is"
        f" off by {of['Euler angles'].y[0]:.1g}: the motion passes near the vertical.",
        quaternion.y[0] < plain.y[0] / 5 and of["Euler angles"].y[0] > 0.1,
    )


def _nudges(nudges: tuple[float, ...] = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)) -> Iterator[Curve]:
    scenes = [nudged(nudge, intervals=400) for nudge in nudges]
    kappa = [sensitivity(s.w0, s.I, s.t_end) for s in scenes]
    yield Curve("κ·2⁻⁵²", [*nudges], [k * EPSILON for k in kappa])
    yield Curve("DOP853, 1e-13", [*nudges], [errors(s, adaptive(s, 1e-13)).w for s in scenes])
    yield Curve("RK8, 3200 steps", [*nudges], [errors(s, BY_NAME["RK8"].run(s, 8)).w for s in scenes])


def _nudges_claims(of: Curves) -> Iterator[Claim]:
    floor, *steppers = of.values()
    ratios = [e / f for one in steppers for e, f in zip(one.y, floor.y, strict=True) if f < 0.1]
    lost = max(x for x, f in zip(floor.x, floor.y, strict=True) if f > 1)
    yield Claim(
        f"κ times the rounding unit predicts how far a stepper in double precision can follow: the errors"
        f" are {min(ratios):.1g} to {max(ratios):.1g} times it.",
        min(ratios) > 0.005 and max(ratios) < 3,
    )
    yield Claim(
        f"From a nudge of {lost:g} down κ·2⁻⁵² exceeds 1: in double precision no stepper can be relied on to"
        f" find the side on which the body passes, at any tolerance (at {floor.x[-1]:g} the errors are"
        f" {' and '.join(f'{one.y[-1]:.2g}' for one in steppers)}). The closed form does.",
        lost == 1e-7 and all(one.y[-1] > 1 for one in steppers),
    )


def _precisions() -> Iterator[Curve]:
    steps = [EXERCISE_2.intervals * s for s in STEPS]
    kappa = sensitivity(EXERCISE_2.w0, EXERCISE_2.I, EXERCISE_2.t_end)
    for name, precision, unit in (("float32", np.float32, EPSILON_SINGLE), ("float64", np.float64, EPSILON)):
        runs = [fixed(RK4, EXERCISE_2, s, precision=precision) for s in STEPS]
        yield Curve(name, steps, [errors(EXERCISE_2, run).w for run in runs])
        yield Curve(f"κ ε of {name}", steps, [kappa * unit] * len(steps))


def _precisions_claims(of: Curves) -> Iterator[Claim]:
    single, double, floor = of["float32"].y, of["float64"].y, of["κ ε of float32"].y[0]
    yield Claim(
        f"In single precision RK4 stops gaining at {single[2]:.1g}; more steps only add rounding, up to"
        f" {max(single[3:]):.1g}. κ ε says {floor:.1g}.",
        single[1] > 5 * single[2] and 0.1 < max(single[3:]) / floor < 3,
    )
    yield Claim(
        f"In double precision the same steps go on to {double[-1]:.1g}, without a floor in sight: choose"
        f" float32 only for errors above {floor:.1g}.",
        all(b < a / 10 for a, b in pairwise(double)),
    )


PICTURES = (
    Picture("Long runs", "periods of ω", "relative error", _long, _long_claims),
    Picture("Large steps", "turn per step / rad", "error of ω", _large, _large_claims),
    Picture("Near the vertical", "tilt at the start / rad", "error of R", _tilts, _tilts_claims),
    Picture("A matrix that is no rotation", "largest |RᵀR − 1|", "error of R", _forms, _forms_claims),
    Picture("Near the separatrix", "nudge / spin", "error of ω", _nudges, _nudges_claims),
    Picture("Single precision", "steps of RK4", "error of ω", _precisions, _precisions_claims),
)


def unfailing() -> Iterator[Claim]:
    """Yield measured claims about what is said to fail and does not."""
    rods = [Scene("rod", (1.0, 0.3, 0.2), (i1, 1.0, 1 + i1 / 2), 1.0, 1) for i1 in (1e-1, 1e-3, 1e-6)]
    calls = [adaptive(rod, 1e-8).calls for rod in rods]
    yield Claim(
        f"A thin rod is no stiff problem: at the same ω DOP853 takes {max(calls)} calls or fewer for I₁ from"
        " 1e-1 to 1e-6 of I₂. Only a fast spin costs steps, with any method.",
        max(calls) <= 1.1 * min(calls),
    )
    tops = [replace(TOP, tilt=tilt) for tilt in (0.6, 1e-2, 1e-6)]
    found = [errors(top, fixed(RK4, top, 10, QUATERNION)).R for top in tops]
    yield Claim(
        f"A heavy top that passes the vertical is no problem for a quaternion: the error is at most"
        f" {max(found):.1g} for starts 0.6 to 1e-6 rad from it.",
        max(found) < 2 * min(found),
    )
    long = replace(EXERCISE_2, t_end=1e8 * PERIOD)
    spent = np.ptp(np.linalg.norm(Exact(long.w0, long.I).momentum(long.t), axis=0))
    yield Claim(
        f"The closed form has no step and no drift: over 10⁸ periods |L| varies by {spent:.1g} of 4.2"
        " kg m²/s.",
        bool(spent < 1e-14),
    )
