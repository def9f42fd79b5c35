"""Cameras: how one axes draws space, as it is, in a plane of two coordinates, or from the student's own view.

A camera is a matrix (d, 3): rows of a rotation, up to a scale. In 2-D axes it may also be oblique: two axes
of space drawn as the axes of the drawing, and the third along any direction.
"""

import itertools

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CROOKED = 0.03  # of the camera's scale
SAME = 0.03  # sine of the angle between directions that count as parallel
PLANES = tuple(itertools.permutations(range(3), 2))


def plain(dimensions: int, first: tuple[int, int] | None = None) -> list[Array]:
    """Return the cameras that draw coordinates as they are: one in 3-D, in 2-D one for each ordered pair.

    The pair ``first`` comes first, then those in the usual order.
    """
    if dimensions == 3:
        return [np.eye(3)]
    return [np.eye(3)[list(plane)] for plane in sorted(PLANES, key=lambda plane: (plane != first, plane[0] > plane[1]))]


def straightened(matrix: Array) -> Array | None:
    """Return the camera that a fitted ``matrix`` (d, 3) represents, without its scale; None if it is not one.
    It may mirror.
    """
    left, sizes, right = np.linalg.svd(matrix, full_matrices=False)
    if sizes[0] <= 0:
        return None
    if sizes[-1] >= (1 - 2 * CROOKED) * sizes[0]:
        return np.asarray(left @ right)
    if len(matrix) == 2:
        for plane in PLANES:
            flat = matrix[:, list(plane)]
            scale = np.sqrt(np.sum(flat**2) / 2)
            whole = np.rint(flat / scale)
            if np.abs(flat - scale * whole).max() <= CROOKED * scale and abs(np.linalg.det(whole)) == 1:
                return np.asarray(matrix / scale)
    return None


def parallel(directions: Array, wanted: Array) -> bool:
    """Return whether one of ``directions`` (k, d) points along ``wanted`` (d,)."""
    lengths = np.linalg.norm(directions, axis=1) * np.linalg.norm(wanted)
    along = directions @ wanted
    return bool(np.any((lengths > 1e-12) & (along >= np.sqrt(1 - SAME**2) * lengths)))


def points_along(some: Array, sure: Array, wanted: Array) -> bool:
    """Return whether a direction points along ``wanted`` (d,). A known tail decides, since matplotlib lists
    an arrow from its tip.
    """
    return parallel(sure, wanted) or (parallel(some, wanted) and not parallel(sure, -wanted))


def of_body(coefficients: Array, design: Array, drawn: Array) -> Array | None:
    """Return the camera M (d, 3) by which v points of the body are drawn as c + M R p, or None.

    M and −M differ by a body turned inside out; the one that does not mirror is returned. ``coefficients``
    (10, v·d) belong to the nine elements of R and a constant, ``design`` (f, 9) holds those elements at each
    frame, ``drawn`` is (f, v, d). M and p are found in turn, from the dyad nearest to the coefficients.
    """
    frames, v, d = drawn.shape
    tensor = coefficients[:9].reshape(3, 3, v, d)  # [a, b, v, i] = M[i, a] p[v, b]
    left, sizes, _ = np.linalg.svd(tensor.transpose(3, 0, 2, 1).reshape(3 * d, 3 * v), full_matrices=False)
    M = (left[:, 0] * sizes[0]).reshape(d, 3)
    R, moved = (design - design.mean(axis=0)).reshape(frames, 3, 3), drawn - drawn.mean(axis=0)
    for _ in range(20):
        seen = np.einsum("ia,fab->fib", M, R).reshape(-1, 3)
        p = np.linalg.lstsq(seen, moved.transpose(0, 2, 1).reshape(-1, v), rcond=None)[0]
        turned = np.einsum("fab,bv->fva", R, p).reshape(-1, 3)
        M = np.linalg.lstsq(turned, moved.reshape(-1, d), rcond=None)[0].T
    left_over = moved.reshape(-1, d) - turned @ M.T
    if np.mean(left_over**2) > CROOKED**2 * np.mean(moved**2):
        return None
    return straightened(-M if d == 3 and np.linalg.det(M) < 0 else M)
