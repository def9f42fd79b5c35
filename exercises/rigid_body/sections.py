"""The six exercises of notebook 2.6: its nine validation lines, and beside them checks against the exact solution.

The notebook's lines alone accept a function that returns zeros and the time-reversed equations, which conserve everything too.
"""

import numpy as np
from numpy.typing import NDArray

import reference
from ecp.film import moving_share
from exercises.assignment import Animation, Exercise
from exercises.checks import Arrays, below, close, conserved, holds
from exercises.rigid_body import figures
from exercises.rigid_body.mistakes import STILL
from exercises.rigid_body.scenes import BODY, NUDGE, SPIN
from exercises.rigid_body.scenes import SYMMETRIC as TOP

Array = NDArray[np.float64]

NOTEBOOK = "the notebook's own tolerance"
ROUNDING = "only rounding separates two spellings of the same algebra at these magnitudes"
DRIVE = "the integrator, at rtol 1e-11, strays less than 1e-9 from the exact motion on this scene"


def _at(index: tuple[int, ...], seen: Arrays) -> str:
    return f"ω{'₁₂₃'[index[0]]}, t = {seen['t'][index[1]]:.4g} s"


def _at_time(index: tuple[int, ...], seen: Arrays) -> str:
    return f"t = {seen['t'][index[0]]:.4g} s"


def _at_probe(index: tuple[int, ...], seen: Arrays) -> str:
    return f"ω̇{'₁₂₃'[index[1]]}, probe {index[0] + 1} of {len(seen['wdot'])}"


def _at_row(index: tuple[int, ...], seen: Arrays) -> str:
    return f"I{'₁₂₃'[index[1]]}, body {index[0] + 1} of {len(seen['moments'])}"


def _omega(name: str, label: str, scene: str, atol: float = 1e-8, reason: str = DRIVE):  # type: ignore[no-untyped-def]
    return close(
        name,
        label,
        scene,
        measured=lambda seen: seen["w"],
        expected=lambda truth: truth["w"],
        rtol=0.0,
        atol=atol,
        reason=reason,
        locate=_at,
    )


def _sorted(arrays: Arrays) -> Array:
    return np.sort(arrays["moments"], axis=-1)


def _growth(*runs: Arrays) -> Array:
    return np.array([reference.transverse_growth(run["w"], axis, SPIN) for axis, run in enumerate(runs)])


def _spin_claim(*runs: Arrays) -> tuple[bool, str]:
    low, mid, high = _growth(*runs)
    steady = 5 * NUDGE
    return bool(low < steady and mid > 10 * steady and high < steady), f"growth: min {low:.3f}, mid {mid:.3f}, max {high:.3f}"


def _moves(seen: Arrays) -> tuple[bool, str]:
    share = moving_share(seen["frames"])
    return share > STILL, f"{len(seen['frames'])} stills, up to {share:.2%} of the picture changes"


MOMENTS = Exercise(
    "1",
    "Principal moments of a box",
    ("box_moments", "principal_moments"),
    (
        close(
            "1-notebook",
            "principal moments match the analytic box result",
            "tensor",
            measured=lambda seen: _sorted(seen)[0],
            expected=lambda truth: truth["moments"][0],
            rtol=1e-10,
            atol=1e-9,
            reason=NOTEBOOK,
        ),
        close(
            "1-boxes",
            "box_moments is m/12 (b² + c²) and cyclically, for any box",
            "boxes",
            measured=lambda seen: seen["moments"],
            expected=lambda truth: truth["moments"],
            rtol=1e-12,
            atol=0.0,
            reason=ROUNDING,
            locate=_at_row,
        ),
        close(
            "1-tensors",
            "principal_moments finds the moments of any tilted box",
            "tensors",
            measured=_sorted,
            expected=lambda truth: truth["moments"],
            rtol=0.0,
            atol=1e-12,
            reason="eigenvalues of a symmetric matrix are exact to a few rounding errors of its norm, here below 10",
            locate=_at_row,
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
            series=lambda seen: reference.kinetic_energy(seen["w"], BODY),
            limit=1e-6,
            reason=NOTEBOOK,
            locate=_at_time,
        ),
        conserved(
            "2-momentum",
            "angular momentum magnitude conserved (torque-free)",
            "torque-free",
            series=lambda seen: reference.momentum_norm(seen["w"], BODY),
            limit=1e-6,
            reason=NOTEBOOK,
            locate=_at_time,
        ),
        close(
            "2-pointwise",
            "euler_eqs agrees with Euler's equations point by point",
            "probes",
            measured=lambda seen: seen["wdot"],
            expected=lambda truth: truth["wdot"],
            rtol=1e-12,
            atol=1e-12,
            reason=ROUNDING,
            locate=_at_probe,
        ),
        _omega("2-motion", "ω(t) follows the exact motion", "torque-free"),
    ),
    figures=(figures.OMEGA, figures.OMEGA_RESIDUAL),
)

POLHODE = Exercise(
    "3",
    "Polhodes",
    ("euler_eqs",),
    (
        close(
            "3-energy",
            "polhode lies on the energy ellipsoid",
            "torque-free",
            measured=lambda seen: reference.kinetic_energy(seen["w"], BODY),
            expected=lambda truth: np.full_like(truth["t"], reference.kinetic_energy(truth["w"][:, 0], BODY)),
            rtol=1e-6,
            atol=1e-9,
            reason=NOTEBOOK,
            locate=_at_time,
        ),
        close(
            "3-momentum",
            "polhode lies on the momentum ellipsoid",
            "torque-free",
            measured=lambda seen: reference.momentum_norm(seen["w"], BODY),
            expected=lambda truth: np.full_like(truth["t"], reference.momentum_norm(truth["w"][:, 0], BODY)),
            rtol=1e-6,
            atol=1e-9,
            reason=NOTEBOOK,
            locate=_at_time,
        ),
        _omega("3-about-3", "polhode about ê₃ is run through at the exact pace", "polhode-3"),
        _omega("3-about-1", "polhode about ê₁ is run through at the exact pace", "polhode-1"),
    ),
    figures=(figures.POLHODE,),
)

SYMMETRIC = Exercise(
    "4",
    "Free precession of a symmetric top",
    ("euler_eqs",),
    (
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
        close(
            "4-rate",
            "free precession rate is (I₃−I₁)/I₁·ω₃",
            "symmetric",
            measured=lambda seen: reference.precession_rate(seen["t"], seen["w"]),
            expected=reference.free_precession_rate(TOP, 3.0),
            rtol=1e-3,
            atol=1e-9,
            reason=NOTEBOOK,
        ),
        _omega("4-motion", "ω(t) of the symmetric top follows the exact motion", "symmetric"),
        close(
            "4-function",
            "precession_rate finds Ω in a given motion",
            "rate",
            measured=lambda seen: seen["rate"],
            expected=lambda truth: truth["rate"],
            rtol=1e-6,
            atol=0.0,
            reason="a fit, a mean of differences and the first and last phase agree to 1e-9 on an even precession",
        ),
    ),
    figures=(figures.PRECESSION,),
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
            "transverse growth about each axis is the exact one",
            "spin-min",
            "spin-mid",
            "spin-max",
            measured=_growth,
            expected=_growth,
            rtol=1e-6,
            atol=0.0,
            reason="seen and exact motion are sampled at the same times, so only the integrator's 1e-9 remains",
            locate=lambda index, *seen: f"spin about ê{'₁₂₃'[index[0]]}",
        ),
        _omega(
            "5-motion",
            "the tumble about the intermediate axis follows the exact motion",
            "spin-mid",
            atol=1e-6,
            reason="near the separatrix this scene magnifies the integrator's 1e-11 by less than 1e4",
        ),
    ),
    figures=(figures.GROWTH, figures.TUMBLE),
)

ATTITUDE = Exercise(
    "6",
    "Animating the free precession",
    ("animate_precession",),
    (
        close(
            "6-orthonormal",
            "R stays orthonormal (max |RᵀR − 1| over the run)",
            "precession",
            measured=lambda seen: reference.orthonormality_error(seen["R"]).max(),
            expected=0.0,
            rtol=1e-6,
            atol=1e-6,
            reason=NOTEBOOK,
        ),
        close(
            "6-attitude",
            "R(t) follows the exact attitude",
            "precession",
            measured=lambda seen: seen["R"],
            expected=lambda truth: truth["R"],
            rtol=0.0,
            atol=1e-8,
            reason=DRIVE,
            locate=lambda index, seen: f"R{index[1] + 1}{index[2] + 1}, t = {seen['t'][index[0]]:.4g} s",
        ),
        below(
            "6-momentum",
            "L stays fixed in space",
            "precession",
            measured=lambda seen: np.ptp(reference.space_momentum(seen["R"], seen["w"], TOP), axis=0),
            limit=1e-8,
            reason=DRIVE,
        ),
        holds(
            "6-moves",
            "animate_precession draws a moving picture",
            "film",
            claim=_moves,
            reason="a picture in which fewer than one pixel in ten thousand changes does not move",
        ),
    ),
    figures=(figures.CONE,),
    animations=(
        Animation(
            "precession",
            "Your animation of the free precession",
            "Contact sheet: stills of the submitted animation in reading order, evenly spaced over its frames.",
            "film",
        ),
    ),
)

EXERCISES = (MOMENTS, EULER, POLHODE, SYMMETRIC, INTERMEDIATE, ATTITUDE)
