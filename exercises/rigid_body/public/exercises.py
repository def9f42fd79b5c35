"""The six exercises of notebook 2.6 with their public checks: the notebook's nine lines and the exact
solution.
"""

import numpy as np

from polhode.judging import judge
from polhode.judging.checks import Arrays, Check, below, close, conserved, holds
from polhode.judging.exercise import Animation, Exercise
from polhode.judging.judge import Judgement
from polhode.judging.outcome import Tolerance
from polhode.kinds.animation.body import keeps_momentum

from . import figures, motions
from .common_checks import DRIVE, NOTEBOOK, at_time, attitude, film, filmed, omega
from .quantities import (
    BODY,
    NUDGE,
    SPIN,
    SYMMETRIC_RATE,
    Array,
    kinetic_energy,
    momentum_norm,
    orthonormality_error,
    space_momentum,
    transverse,
    turning_rate,
)
from .quantities import SYMMETRIC as SYMMETRIC_BODY

MOMENTS = Exercise(
    "1",
    "Principal moments of a box",
    ("box_moments", "principal_moments"),
    (
        close(
            "1-notebook",
            "principal moments match the analytic box result",
            "tensor",
            measured=lambda seen: np.sort(seen["moments"], axis=-1)[0],
            expected=lambda truth: truth["moments"][0],
            rtol=1e-10,
            atol=1e-9,
            reason=NOTEBOOK,
        ),
    ),
    figures=(figures.BOX,),
)

EULER = Exercise(
    "2",
    "Euler's equations",
    ("euler_eqs",),
    (
        conserved(
            "2-energy",
            "rotational energy conserved (torque-free)",
            "torque-free",
            series=lambda seen: kinetic_energy(seen["w"], BODY),
            limit=1e-6,
            reason=NOTEBOOK,
            locate=at_time,
        ),
        conserved(
            "2-momentum",
            "|L| conserved (torque-free)",
            "torque-free",
            series=lambda seen: momentum_norm(seen["w"], BODY),
            limit=1e-6,
            reason=NOTEBOOK,
            locate=at_time,
        ),
        omega("2-motion", "ω(t) follows the exact motion", "torque-free"),
    ),
    figures=(figures.OMEGA, figures.OMEGA_RESIDUAL),
    motions=(motions.TORQUE_FREE,),
)

POLHODE = Exercise(
    "3",
    "Polhodes",
    ("euler_eqs",),
    (
        close(
            "3-energy",
            "ω stays on the energy ellipsoid (T constant)",
            "torque-free",
            measured=lambda seen: kinetic_energy(seen["w"], BODY),
            expected=lambda truth: np.full_like(truth["t"], kinetic_energy(truth["w"][:, 0], BODY)),
            rtol=1e-6,
            atol=1e-9,
            reason=NOTEBOOK,
            locate=at_time,
        ),
        close(
            "3-momentum",
            "ω stays on the angular-momentum ellipsoid (|L| constant)",
            "torque-free",
            measured=lambda seen: momentum_norm(seen["w"], BODY),
            expected=lambda truth: np.full_like(truth["t"], momentum_norm(truth["w"][:, 0], BODY)),
            rtol=1e-6,
            atol=1e-9,
            reason=NOTEBOOK,
            locate=at_time,
        ),
        omega("3-about-3", "ω(t) on the polhode about ê₃ follows the exact motion", "polhode-3"),
        omega("3-about-1", "ω(t) on the polhode about ê₁ follows the exact motion", "polhode-1"),
    ),
    figures=(figures.POLHODE,),
)

RTOL, ATOL = 1e-3, 1e-9


def _turns(seen: list[Arrays], truth: list[Arrays]) -> Judgement:
    rate = turning_rate(seen[0]["t"], seen[0]["w"], truth[0]["w"], SYMMETRIC_RATE)
    return judge.close(rate, SYMMETRIC_RATE, RTOL, ATOL)


SYMMETRIC = Exercise(
    "4",
    "Free precession of a symmetric top",
    ("euler_eqs",),
    (
        Check(
            "4-rate",
            "free precession rate is (I₃−I₁)/I₁·ω₃",
            ("symmetric",),
            _turns,
            Tolerance(rtol=RTOL, atol=ATOL, reason=NOTEBOOK),
        ),
        close(
            "4-constant",
            "ω₃ is constant for the symmetric top",
            "symmetric",
            measured=lambda seen: np.ptp(seen["w"][2]),
            expected=0.0,
            rtol=1e-6,
            atol=1e-9,
            reason=NOTEBOOK,
        ),
        omega("4-motion", "ω(t) of the symmetric top follows the exact motion", "symmetric"),
    ),
    figures=(figures.PRECESSION,),
    optional=("precession_rate",),
)


def _growth(*runs: Arrays) -> Array:
    return np.array([transverse(run["w"], axis, SPIN).max() for axis, run in enumerate(runs)])


def _spin_claim(*runs: Arrays) -> tuple[bool, str]:
    low, mid, high = _growth(*runs)
    steady = 5 * NUDGE
    return (
        bool(low < steady and mid > 10 * steady and high < steady),
        f"growth: min {low:.3f}, mid {mid:.3f}, max {high:.3f}",
    )


INTERMEDIATE = Exercise(
    "5",
    "The intermediate axis",
    ("euler_eqs",),
    (
        holds(
            "5-notebook",
            "spin is stable about the extreme axes, unstable about the intermediate axis",
            "spin-min",
            "spin-mid",
            "spin-max",
            claim=_spin_claim,
            reason="steady: growth under 5 times the nudge; unstable: over 50 times",
        ),
        close(
            "5-growth",
            "transverse growth about each axis matches the exact motion",
            "spin-min",
            "spin-mid",
            "spin-max",
            measured=_growth,
            expected=lambda *truth: np.array([exact["growth"] for exact in truth]),
            rtol=1e-4,
            atol=0.0,
            reason="the largest of 1500 samples misses a maximum between two of them by less than 1e-4 of it",
            locate=lambda index, *seen: f"spin about ê{'₁₂₃'[index[0]]}",
        ),
        omega("5-motion", "the tumble about the intermediate axis follows the exact motion", "spin-mid"),
        *film("5", "tumble-film", "animate_tumble", "the body"),
    ),
    figures=(figures.GROWTH, figures.TUMBLE),
    animations=(
        Animation(
            "tumble-yours",
            "Your animation of the tumbling box",
            "Contact sheet: stills of the submitted animation in reading order, evenly spaced over its"
            " frames.",
            "tumble-film",
        ),
    ),
    optional=("animate_tumble",),
    motions=motions.SPINS,
)

ATTITUDE = Exercise(
    "6",
    "Animating the free precession",
    ("animate_precession",),
    (
        close(
            "6-orthonormal",
            "the integrated orientation stays a proper rotation (RᵀR=I)",
            "precession",
            measured=lambda seen: orthonormality_error(seen["R"]).max(),
            expected=0.0,
            rtol=1e-6,
            atol=1e-6,
            reason=NOTEBOOK,
        ),
        attitude("6-attitude", "R(t) follows the exact attitude", "precession"),
        below(
            "6-momentum",
            "L stays fixed in space",
            "precession",
            measured=lambda seen: np.ptp(space_momentum(seen["R"], seen["w"], SYMMETRIC_BODY), axis=0),
            limit=1e-8,
            reason=DRIVE,
        ),
        *film("6", "film", "animate_precession", "the body axis ê₃(t)"),
        keeps_momentum(
            "6-drawn-momentum", "what animate_precession draws along L stays fixed", "film", filmed
        ),
    ),
    figures=(figures.CONE,),
    animations=(
        Animation(
            "precession",
            "Your animation of the free precession",
            "Contact sheet: stills of the submitted animation in reading order, evenly spaced over its"
            " frames.",
            "film",
        ),
    ),
    motions=(motions.PRECESSION,),
    prerequisites=("euler_eqs",),
)

EXERCISES = (MOMENTS, EULER, POLHODE, SYMMETRIC, INTERMEDIATE, ATTITUDE)
