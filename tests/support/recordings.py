"""Recordings of animations of a rotating body, as the recorder returns them, without drawing: paths of points
in axes.
"""

import numpy as np
from scipy.spatial.transform import Rotation

import reference
from polhode.kinds.animation.body import Body

TILT = Rotation.from_rotvec(
    [-2.0, 1.0, 0.0]
).as_matrix()  # keeps L and the axis off every coordinate axis and plane
T = np.linspace(0.0, 4.0, 96)
N = len(T)
ALL = np.arange(N)
HALF = np.array([1.0, 0.7, 0.2])
CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-0.7, 0.7) for z in (-0.2, 0.2)])


def attitudes(spin, moments):
    """Return the exact attitudes (n, 3, 3) of a free body at the times T."""
    return TILT @ reference.motion(spin, moments, T, need="orientation").R


SPIN, MOMENTS = (2.2, 0.0, 0.5), (1.25, 1.25, 2.0)
R, L = attitudes(SPIN, MOMENTS), TILT @ reference.angular_momentum(SPIN, MOMENTS)
UNIT, TIP = L / np.linalg.norm(L), R[:, :, 2]
TUMBLE = attitudes((0.1, 3.0, 0.15), reference.box_moments(1.0, *(2 * HALF)))
TOP, BOX = Body(T, R, axis=2, L=L), Body(T, TUMBLE, half=HALF)

VIEW = Rotation.from_rotvec([0.3, 0.9, -0.5]).as_matrix()
ISOMETRIC = np.array([[-1, 1, 0], [-1, -1, 2]]) / np.array([[np.sqrt(2)], [np.sqrt(6)]])
CABINET = np.array([[1, -0.35, 0], [0, -0.35, 1]])
SPACE = np.eye(3)
XY, XZ, YX = np.eye(3)[[0, 1]], np.eye(3)[[0, 2]], np.eye(3)[[1, 0]]


def frames(*artists, values=None):
    """What the driver brings back for artists (points, f, 2 or 3), each a list of paths, in one axes."""
    total = len(artists[0][0])
    followed = np.arange(total)
    paths = [path for artist in artists for path in artist]
    tracks = np.zeros((len(followed), len(paths), 3))
    for number, path in enumerate(paths):
        tracks[:, number, : path.shape[1]] = path[followed]
    owners = [[k, artist[0].shape[1], 0] for k, artist in enumerate(artists) for _ in artist]
    named = followed if values is None else np.asarray(values)[followed]
    at = np.column_stack([followed, named, np.full(len(followed), total)]).astype(float)
    cost = np.array([total, 1.0, 0.0, 0.0, 0.0, 0.0])
    return {
        "tracks": tracks,
        "owners": np.array(owners, float),
        "labels": -np.ones((1, 3)),
        "at": at,
        "cost": cost,
        "visible": np.array([1.0, 0.0]),
    }


def panels(*drawn, labels=()):
    """Several of these as the axes of one figure, with the ``labels`` of some: (axes, horizontal,
    vertical).
    """
    owners = [one["owners"] + [100 * k, 0, k] for k, one in enumerate(drawn)]
    together = {
        "tracks": np.concatenate([one["tracks"] for one in drawn], axis=1),
        "owners": np.concatenate(owners),
    }
    return drawn[0] | together | {"labels": np.array(labels or [(-1, -1, -1)], float)}


def watched(*paths):
    """Each path its own artist."""
    return frames(*([path] for path in paths))


def line(tip, tail=0.0):
    """An artist from ``tail`` to ``tip`` (f, d)."""
    return [np.zeros_like(tip) + tail, tip + tail]


def scene(tip, L=UNIT, camera=SPACE, momentum=True, values=None):
    """An arrow along ``tip`` (f, 3) and one along L, drawn by ``camera``."""
    arrows = [line(tip @ camera.T)] + ([line(np.tile(camera @ L, (len(tip), 1)))] if momentum else [])
    return frames(*arrows, values=values)
