"""Cameras: how one axes draws space, as it is, in a plane of two coordinates, or from the student's own view.

A camera is a matrix (d, 3): rows of a rotation, up to a scale. In 2-D axes it may also be oblique: two axes
of space drawn as the axes of the drawing, and the third along any direction.
"""

import itertools

import numpy as np

from polhode.kinds.animation.frame_times import Array

CROOKED = 0.03  # of the camera's scale
PARALLEL = 0.03  # sine of the angle between directions that count as parallel
SKEW = 0.1  # sine of the angle between the line of sight and the normal of a drawing in perspective
PLANES = tuple(itertools.permutations(range(3), 2))


def plain(dimensions: int, first: tuple[int, int] | None = None, coordinates: int = 3) -> list[Array]:
    """Return the matrices that draw 2 or 3 coordinates as they are: one, or one for each ordered pair of
    three, ``first`` first.
    """
    if dimensions == coordinates:
        return [np.eye(dimensions)]
    planes = sorted(PLANES, key=lambda plane: (plane != first, plane[0] > plane[1]))
    return [np.eye(3)[list(plane)] if dimensions == 2 else np.eye(3)[:, list(plane)] for plane in planes]


def straightened(matrix: Array) -> Array | None:
    """Return the camera, perhaps a mirroring one, that a fitted ``matrix`` (d, 3) represents, without its
    scale; or None.
    """
    left, sizes, right = np.linalg.svd(matrix, full_matrices=False)
    if sizes[0] > 0 and sizes[-1] >= (1 - 2 * CROOKED) * sizes[0]:
        return np.asarray(left @ right)
    for plane in PLANES if len(matrix) == 2 and sizes[0] > 0 else ():
        flat = matrix[:, list(plane)]
        scale = np.sqrt(np.sum(flat**2) / 2)
        whole = np.rint(flat / scale)
        if np.abs(flat - scale * whole).max() <= CROOKED * scale and abs(np.linalg.det(whole)) == 1:
            return np.asarray(matrix / scale)
    return None


def mislabelled(plane: tuple[int, int] | None, camera: Array) -> str:
    """Return which coordinates a ``camera`` (2, 3) draws instead of those of ``plane``, which the labels
    name, or "".
    """
    whole = np.rint(camera)
    shown = [int(k) for k in np.argmax(np.abs(whole), axis=1)]
    signs = [whole[row, k] for row, k in enumerate(shown)]
    if (
        plane is None
        or np.abs(camera - whole).max() > PARALLEL
        or (shown == list(plane) and signs[0] == signs[1])
    ):
        return ""
    names = " and ".join(f"{'−' if sign < 0 else ''}{'xyz'[k]}" for k, sign in zip(shown, signs, strict=True))
    return f"axes labelled {' and '.join('xyz'[k] for k in plane)} show {names}"


def parallel(directions: Array, wanted: Array) -> bool:
    """Return whether one of ``directions`` (k, d) points along ``wanted`` (d,)."""
    lengths = np.linalg.norm(directions, axis=1) * np.linalg.norm(wanted)
    return bool(np.any((lengths > 1e-12) & (directions @ wanted >= np.sqrt(1 - PARALLEL**2) * lengths)))


def in_perspective(points: Array, places: Array) -> tuple[Array, Array]:
    """Return M (2, m) and q (3,) by which ``points`` (k, m) are best drawn at ``places`` (k, 2), as M p / (1
    − q·p).

    The first three coordinates of a point are its place in space; a constant one may follow.
    """
    none = np.zeros_like(points)
    rows = [
        np.column_stack([*np.roll([points, none], row, axis=0), places[:, [row]] * points[:, :3]])
        for row in (0, 1)
    ]
    fit = np.linalg.lstsq(np.concatenate(rows), places.T.ravel(), rcond=None)[0]
    return fit[:-3].reshape(2, -1), fit[-3:]
