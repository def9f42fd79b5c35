"""The least model that a scene needs: a table whose evidence is measured."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from reference.charts.cost import ENOUGH, RTOL, interleaved
from reference.charts.deviations import errors
from reference.charts.failures import BY_NAME, EPSILON, EPSILON_SINGLE
from reference.charts.scenes import EXERCISE_2, EXERCISE_5, EXERCISE_6, TOP, nudged
from reference.exact import Exact
from reference.methods.runge_kutta import RK4, fixed, in_scipy
from reference.methods.states import MATRIX, QUATERNION
from reference.stability import sensitivity

MANY = 2000


class Row(NamedTuple):
    """What a scene asks for, the least model that gives it, the measured evidence, and whether it supports
    the row.
    """

    scene: str
    model: str
    evidence: str
    holds: bool


def table(rounds: int = 9) -> Iterator[Row]:
    """Yield the rows of the table, measured now."""
    motions = {
        "steady": Exact((0.0, 0.0, 3.0), EXERCISE_2.I),
        "symmetric": Exact(EXERCISE_6.w0, EXERCISE_6.I),
        "dual": Exact(EXERCISE_2.w0, EXERCISE_2.I),
    }
    times = np.linspace(0.0, EXERCISE_2.t_end, MANY)
    whole: dict[str, Callable[[], object]] = {
        **{name: partial(exact.omega, times) for name, exact in motions.items()},
        "with R": partial(motions["dual"].sample, times, orientation=True),
        "in SciPy": partial(in_scipy, replace(EXERCISE_2, intervals=MANY - 1), 1e-11),
    }
    us = {name: 1e6 * seconds for name, seconds in interleaved(whole, rounds).items()}
    change = float(np.ptp(motions["steady"].omega(times), axis=1).max())
    yield Row(
        "a sphere, or a spin about a principal axis",
        "constant ω",
        f"ω changes by {change:g} in {MANY} samples, which take {us['steady']:.0f} µs",
        change == 0 and us["steady"] < us["dual"],
    )
    spread = float(np.ptp(np.hypot(*motions["symmetric"].omega(times)[:2])))
    yield Row(
        "two equal moments",
        "circular functions",
        f"the transverse ω keeps its size to {spread:.0e}; {us['symmetric']:.0f} µs, against"
        f" {us['dual']:.0f} µs for the theta series of three different moments",
        spread < 1e-14 and us["symmetric"] < us["dual"],
    )
    yield Row(
        "the angular velocity only",
        "the closed form without R",
        f"{MANY} samples take {us['dual']:.0f} µs, with R {us['with R']:.0f} µs",
        us["dual"] < us["with R"],
    )
    yield Row(
        "thousands of samples, or any accuracy",
        "the closed form",
        f"{us['with R']:.0f} µs to rounding, against {us['in SciPy'] / 1e3:.0f} ms for DOP853 in SciPy at"
        " rtol 1e-11",
        us["with R"] < us["in SciPy"] / 10,
    )
    yield from _of_steppers()


def _of_steppers() -> Iterator[Row]:
    scenes = (EXERCISE_2, EXERCISE_5, EXERCISE_6, TOP)
    runs = [in_scipy(scene, RTOL) for scene in scenes]
    error = max(max(errors(scene, run)[:2]) for scene, run in zip(scenes, runs, strict=True))
    yield Row(
        f"your own right-hand side, error {ENOUGH:g}",
        f"an adaptive stepper, rtol {RTOL:g}",
        f"DOP853 takes {min(r.calls for r in runs)} to {max(r.calls for r in runs)} calls on"
        f" {len(scenes)} scenes; the largest error is {error:.0e}",
        error < ENOUGH,
    )
    matrix, quaternion = (
        errors(EXERCISE_2, fixed(RK4, EXERCISE_2, 4, form)).R for form in (MATRIX, QUATERNION)
    )
    yield Row(
        "an animation on the screen",
        "fixed-step RK4 with a quaternion",
        f"160 steps for 20 s: error {quaternion:.0e}, below a pixel (0.001); with a matrix {matrix:.0e}",
        quaternion < 1e-3 and quaternion < matrix / 3,
    )
    long = replace(TOP, t_end=50 * TOP.t_end, intervals=50 * TOP.intervals)
    split, drift = (
        [errors(s, m.run(s, 5)).energy for s in (TOP, long)] for m in (BY_NAME["splitting 6"], BY_NAME["RK4"])
    )
    yield Row(
        "a torque, for a long time",
        "splitting",
        f"heavy top, 50 steps a second, after 4 s and 200 s: the energy error is {split[0]:.0e} and"
        f" {split[1]:.0e}; with RK4 {drift[0]:.0e} and {drift[1]:.0e}",
        split[1] < 3 * split[0] and drift[1] > 10 * drift[0],
    )
    floors = {n: EPSILON * sensitivity(s.w0, s.I, s.t_end) for n in (1e-6, 1e-7) for s in (nudged(n),)}
    yield Row(
        "near the separatrix",
        "the closed form only",
        f"κ·2⁻⁵² is {floors[1e-6]:.1g} at a nudge of 1e-6 and {floors[1e-7]:.1g} at 1e-7, two passages on",
        floors[1e-6] < 1 < floors[1e-7],
    )
    single = errors(EXERCISE_2, fixed(RK4, EXERCISE_2, 32, precision=np.float32)).w
    bound = EPSILON_SINGLE * sensitivity(EXERCISE_2.w0, EXERCISE_2.I, EXERCISE_2.t_end)
    yield Row(
        "single precision",
        "only for errors above κ·2⁻²³",
        f"exercise 2: κ·2⁻²³ = {bound:.0e}, RK4 with {32 * EXERCISE_2.intervals} steps reaches {single:.0e}",
        0.1 < single / bound < 3,
    )
