"""The hidden checks, with random inputs, after the public ones of each exercise.

The notebook's own checks accept a function that returns zeros, and the time-reversed equations, which
conserve everything too.
"""

import numpy as np

from exercises.rigid_body.bounds import bounded
from polhode.judging.checks import Arrays, Check, close, within

ROUNDING = "correct formulas differ only by rounding at these magnitudes"
EVEN = (
    "the notebook's own tolerance: every correct way to compute a mean rate from the phase agrees to rounding"
)


def at_moment(index: tuple[int, ...], seen: Arrays) -> str:
    """Return moment and body of an index into moments (n, 3)."""
    return f"I{'₁₂₃'[index[1]]}, body {index[0] + 1} of {len(seen['moments'])}"


def at_box(index: tuple[int, ...], seen: Arrays) -> str:
    """Return the box (m, a, b, c) of an index into moments (n, 3), and the returned and expected values."""
    return (
        f"I{'₁₂₃'[index[1]]}, (m, a, b, c) = {_vector(seen['at'][index[0]])}:"
        f" {_compared(seen, 'moments', index)}"
    )


def at_point(index: tuple[int, ...], seen: Arrays) -> str:
    """Return the point (ω, I) of an index into rates (n, 3), and the returned and expected values."""
    point = f"ω = {_vector(seen['at_w'][index[0]])}, I = {_vector(seen['at_I'][index[0]])}"
    return f"ω̇{'₁₂₃'[index[1]]}, {point}: {_compared(seen, 'wdot', index)}"


def _vector(numbers: Arrays) -> str:
    return f"({', '.join(f'{x:z.4g}' for x in numbers)})"


def _compared(seen: Arrays, name: str, index: tuple[int, ...]) -> str:
    got, expected = float(seen[name][index]), float(seen["exact"][index])
    few, digits = f"{got:z.4g}", 4
    while few == f"{expected:z.{digits}g}" and digits < 17:  # enough digits to show a difference
        digits += 1
        few = f"{got:z.{digits}g}"
    return f"got {few}, expected {expected:z.{digits}g}"


def at_body(index: tuple[int, ...], seen: Arrays) -> str:
    """Return the body of an index into (n,)."""
    return f"body {index[0] + 1} of {len(seen['moments'])}"


def pointwise(id: str) -> Check:
    """Return the check that ``euler_eqs`` is right at random (t, ω, I), for every exercise that it drives.

    The exercise's own scene, with one known body, would accept equations that are right for that body only.
    """
    return within(
        id,
        "euler_eqs agrees with Euler's equations point by point",
        "probes",
        measured=lambda seen: seen["wdot"],
        expected=lambda truth: truth["wdot"],
        scale=lambda truth: truth["scale"],
        limit=1e-13,
        reason="of the largest Iω² over each moment: far above the rounding error of any correct formula",
        locate=at_point,
    )


def precession(id: str, label: str, scene: str) -> Check:
    """Return the check of ``precession_rate`` for one given motion."""
    return close(
        id,
        label,
        scene,
        measured=lambda seen: seen["rate"],
        expected=lambda truth: truth["rate"],
        rtol=1e-3,
        atol=0.0,
        reason=EVEN,
    )


BOXES = (
    within(
        "1-boxes",
        "box_moments is m/12 (b² + c²) and cyclically, for any box",
        "boxes",
        measured=lambda seen: seen["moments"],
        expected=lambda truth: truth["moments"],
        scale=lambda truth: truth["moments"].max(axis=1, keepdims=True),
        limit=1e-12,
        reason=f"of the body's largest moment: {ROUNDING}",
        locate=at_box,
    ),
    within(
        "1-tensors",
        "principal_moments finds the moments of any tilted box",
        "tensors",
        measured=lambda seen: np.sort(seen["moments"], axis=-1),
        expected=lambda truth: truth["moments"],
        scale=lambda truth: np.maximum(truth["moments"].max(axis=1, keepdims=True), 1.0),
        limit=1e-9,
        reason=(
            "of the largest moment, or of 1 kg m²: eigenvalues are exact to rounding, roots of a polynomial"
            " lose a few digits"
        ),
        locate=at_moment,
    ),
    close(
        "1-trace",
        "the sum of the moments is the trace of the tensor",
        "tensors",
        measured=lambda seen: seen["moments"].sum(axis=1),
        expected=lambda truth: truth["trace"],
        rtol=1e-12,
        atol=0.0,
        reason=ROUNDING,
        locate=at_body,
    ),
    close(
        "1-determinant",
        "the product of the moments is the determinant of the tensor",
        "tensors",
        measured=lambda seen: seen["moments"].prod(axis=1),
        expected=lambda truth: truth["determinant"],
        rtol=1e-9,
        atol=1e-12,
        reason="a small moment is exact to rounding of the largest one, so the product loses a few digits",
        locate=at_body,
    ),
)

FOLLOWING = ("2-motion", "3-about-3", "3-about-1", "4-motion", "5-motion", "6-attitude")
"""Public checks of a motion against the exact one, which also need the bound of bounds.py."""
HIDDEN: dict[str, tuple[Check, ...]] = {
    "1": BOXES,
    "2": (
        pointwise("2-pointwise"),
        bounded("2-secret", "ω(t) of a new random body follows the exact motion for sixty radians", "long"),
    ),
    "3": (
        pointwise("3-pointwise"),
        bounded(
            "3-secret-greatest", "ω(t) of a new random body about its axis of the greatest moment", "greatest"
        ),
        bounded("3-secret-least", "ω(t) of a new random body about its axis of the least moment", "least"),
    ),
    "4": (
        pointwise("4-pointwise"),
        bounded("4-secret", "ω(t) of a new random symmetric top follows the exact motion", "symmetric top"),
        bounded("4-sphere", "ω of a body with three equal moments stays constant", "sphere"),
        precession("4-function", "precession_rate finds Ω in a given motion", "rate"),
        precession(
            "4-retrograde", "precession_rate is negative if (ω₁, ω₂) turns backwards", "rate-retrograde"
        ),
        precession(
            "4-coarse", "precession_rate finds Ω with samples up to 0.47 of a turn apart", "rate-coarse"
        ),
        precession("4-short", "precession_rate finds Ω in less than one turn", "rate-short"),
    ),
    "5": (
        pointwise("5-pointwise"),
        bounded("5-secret", "a new random body turns over at the right times", "tumble"),
    ),
    "6": (
        pointwise("6-pointwise"),
        bounded("6-secret", "R(t) of a new random body follows the exact attitude", "attitude"),
    ),
}
