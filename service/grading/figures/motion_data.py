"""Data of an animated motion: a submission's attitude R(t) and the exact one, in a few thousand bytes.

A submission's R may be no rotation, or not finite, from some sample on. Its motion is shown up to that
sample.
"""

import json
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from exercises.authoring.assignments.assignment import Assignment
from polhode.judging.checks import Arrays
from polhode.judging.exercise import Motion
from service.grading.sandbox_job import draw_inputs, truth

Array = NDArray[np.float64]
FRAMES = 120
SCALE = 9999  # unit quaternions as integers of at most four digits: steps of 0.01°
NEAR = 0.1  # |RᵀR − 1| up to which the nearest rotation is shown
NOTICEABLE = 1e-6  # deviation from which it is mentioned
ALIKE = 1e-5  # degrees, below which two attitudes count as equal


class ValidPrefix(NamedTuple):
    """Rotations ``R`` (m, 3, 3) of the first m samples that can be shown, and ``off``, the student's largest
    |RᵀR − 1| there.
    """

    R: Array
    off: float


def find(assignment: Assignment, name: str) -> Motion | None:
    """Return the motion of that name, or None."""
    return next((m for e in assignment.exercises for m in e.motions if m.name == name), None)


def to_json(assignment: Assignment, motion: Motion, arrays: Arrays, seed: int) -> bytes:
    """Return the motion as JSON for the arrays of its scene. Raises ValueError if they do not fit the scene.

    ``t`` (f,) in ms, ``half`` (3,), ``axis``, the direction ``L`` (3,) in space of the exact angular
    momentum, unit quaternions (w, x, y, z) frame after frame for ``exact`` (4 f,) and ``yours`` (at most 4
    f,), in 1/SCALE. ``notes`` are sentences about the motion.
    """
    scene = assignment.scene(motion.scene)
    exact = truth(scene, draw_inputs(scene, seed))
    t, R = exact["t"], exact["R"]
    given = np.asarray(arrays.get("R"))
    if given.shape != R.shape or given.dtype.kind != "f":
        raise ValueError("the submission returned no attitude")
    yours, at = valid_prefix(given), np.linspace(0, len(t) - 1, min(FRAMES, len(t))).astype(int)
    document = {
        "t": np.round(1e3 * t[at]).astype(int).tolist(),
        "half": [round(x, 4) for x in motion.half],
        "axis": motion.axis,
        "scale": SCALE,
        "L": np.round(_momentum(motion, exact), 4).tolist(),
        "exact": _whole(quaternions(R[at])),
        "yours": _whole(quaternions(yours.R[at[at < len(yours.R)]])),
        "notes": _notes(yours, given, t, R, at),
    }
    return json.dumps(document, ensure_ascii=False, allow_nan=False, separators=(",", ":")).encode()


def valid_prefix(R: Array) -> ValidPrefix:
    """Return the rotations nearest to ``R`` (n, 3, 3), up to the first sample that is too far from any
    rotation.
    """
    with np.errstate(all="ignore"):
        off = np.abs(np.swapaxes(R, 1, 2) @ R - np.eye(3)).max(axis=(1, 2))
        good = np.isfinite(off) & (off <= NEAR) & (np.linalg.det(np.where(np.isfinite(R), R, 0.0)) > 0)
    many = len(R) if good.all() else int(np.argmin(good))
    left, _, right = np.linalg.svd(R[:many])
    return ValidPrefix(left @ right, float(off[:many].max(initial=0.0)))


def quaternions(R: Array) -> Array:
    """Return unit quaternions (m, 4) of rotations (m, 3, 3), each with the sign nearer to the one before."""
    if not len(R):
        return np.zeros((0, 4))
    x, y, z = R[:, 0, 0], R[:, 1, 1], R[:, 2, 2]
    squares = np.maximum(1 + np.stack([x + y + z, x - y - z, y - x - z, z - x - y], axis=1), 0) / 4
    q = np.sqrt(squares)
    largest, rows = q.argmax(axis=1), np.arange(len(R))
    plus, minus = R + np.swapaxes(R, 1, 2), R - np.swapaxes(R, 1, 2)
    w, a, b = minus[:, [2, 0, 1], [1, 2, 0]], plus[:, 0], plus[:, 1]
    products = np.zeros((len(R), 4, 4))  # four times qᵢqⱼ, off the diagonal
    products[:, 0, 1:] = products[:, 1:, 0] = w
    products[:, 1, 2] = products[:, 2, 1] = a[:, 1]
    products[:, 1, 3] = products[:, 3, 1] = a[:, 2]
    products[:, 2, 3] = products[:, 3, 2] = b[:, 2]
    q = np.where(np.arange(4) == largest[:, None], q, products[rows, largest] / (4 * q[rows, largest, None]))
    sides = np.where(np.einsum("ij,ij->i", q[1:], q[:-1]) < 0, -1.0, 1.0)
    return np.asarray(q * np.concatenate([[1.0], np.cumprod(sides)])[:, None])


def _whole(q: Array) -> list[int]:
    whole: list[int] = np.round(SCALE * q).astype(int).ravel().tolist()
    return whole


def _momentum(motion: Motion, exact: Arrays) -> Array:
    """Return the direction (3,) of the exact L in space."""
    squares = np.square(motion.half)
    L = exact["R"][0] @ ((squares.sum() - squares) * exact["w"][:, 0])
    return np.asarray(L / np.linalg.norm(L))


def _notes(yours: ValidPrefix, given: Array, t: Array, R: Array, shown: NDArray[np.intp]) -> list[str]:
    """Return sentences on the largest difference, of the samples that are ``shown``, and on those that cannot
    be.
    """
    many, notes = len(yours.R), []
    if many:
        halves = np.linalg.norm(yours.R - R[:many], axis=(1, 2)) / np.sqrt(8)
        apart = np.degrees(2 * np.arcsin(np.minimum(halves, 1.0)))
        shown = shown[shown < many]
        most = int(shown[apart[shown].argmax()])  # where the player starts
        alike = apart.max() < ALIKE
        notes.append(
            f"Never more than {ALIKE:.5f}° apart."
            if alike
            else f"Farthest apart at t = {round(t[most], 3):.2f} s, by {apart[most]:.1f}°."
        )
    if yours.off > NOTICEABLE:
        notes.append(
            f"Your R is not quite a rotation, max |RᵀR − 1| = {yours.off:.2g}: the nearest rotation is shown."
        )
    if many < len(t):
        notes.append(
            f"{'From' if many else 'At'} t = {t[many]:.3g} s {'on ' if many else ''}{_why(given[many])}."
        )
    return notes


def _why(R: Array) -> str:
    if not np.isfinite(R).all():
        return "your R is not finite"
    with np.errstate(all="ignore"):
        off = float(np.abs(R.T @ R - np.eye(3)).max())
    return (
        f"your R is not a rotation: max |RᵀR − 1| = {off:.3g}"
        if off > NEAR
        else "your R is a reflection, not a rotation"
    )
