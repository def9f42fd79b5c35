"""Paths of drawn points beside the motion: in any style, and the wrong ones told apart."""

import numpy as np
import pytest

import reference
from exercises.rigid_body.public.watched import body_shown, momentum_shown

T = np.linspace(0.0, 4.0, 96)
W0, I = (0.9, 0.0, 1.4), (1.0, 1.0, 1.6)
R = reference.motion(W0, I, T, need="orientation").R
L = reference.angular_momentum(W0, I)
VIEW = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
VIEW = VIEW * np.sign(np.linalg.det(VIEW))


def watched(*paths, dimensions=3, at=None):
    """What the driver brings back for these paths (f, 3) or (f, 2), each its own artist."""
    frames = len(paths[0])
    tracks = np.zeros((frames, len(paths), 3))
    for number, path in enumerate(paths):
        tracks[:, number, : path.shape[1]] = path
    number = np.arange(frames) if at is None else at
    counted = np.column_stack([number, number, np.full(frames, frames)]).astype(float)
    owners = np.array([[k, dimensions] for k in range(len(paths))], dtype=float)
    return {"tracks": tracks, "owners": owners, "at": counted, "cost": np.array([frames, 1.0, 0.0, 0.0, 0.0])}


def line(tip, tail=0.0):
    """The two ends of one artist."""
    seen = watched(tip, np.zeros_like(tip) + tail)
    seen["owners"][:, 0] = 0
    return seen


TIP = R[:, :, 2]
CORNER = R @ np.array([1.0, 0.7, 0.2])


@pytest.mark.parametrize(
    "seen",
    [
        watched(TIP),
        watched(0.8 * TIP + [1.0, 2.0, 3.0]),
        line(TIP),
        line(TIP @ VIEW.T),
        watched(CORNER),
        watched(TIP[:, :2], dimensions=2),
        watched(TIP[:, [2, 0]] * 3.0, dimensions=2),
        watched((TIP @ VIEW.T)[:, :2], dimensions=2),
        watched(R[:, :, 0], R[:, :, 1]),
        watched(TIP[::2]),
        watched(TIP + 0.005 * np.random.default_rng(2).normal(size=TIP.shape)),
    ],
    ids=["tip", "scaled", "line", "turned", "corner", "plane", "other plane", "projected", "disc", "every second", "shaky"],
)
def test_right_drawings(seen):
    assert body_shown(seen, T, R, 2).found is True


@pytest.mark.parametrize(
    ("seen", "code"),
    [
        (line(R[:, :, 0]), "wrong-axis"),
        (line(R[:, :, 1]), "wrong-axis"),
        (line(R[:, 2, :]), "transposed-rotation"),
        (line(TIP[::-1]), "wrong-motion"),
        (line(np.random.default_rng(3).normal(size=TIP.shape)), "wrong-motion"),
        (line(np.column_stack([np.cos(3 * T), np.sin(3 * T), 0 * T])), "wrong-motion"),
        (watched(R[:, 2, :2], dimensions=2), "transposed-rotation"),
    ],
    ids=["e1", "e2", "transposed", "backwards", "noise", "about z", "transposed flat"],
)
def test_wrong_drawings(seen, code):
    shown = body_shown(seen, T, R, 2)
    assert shown.found is False and shown.code == code


def test_what_stands_still_is_not_the_body_unless_a_picture_is_painted():
    still = watched(np.ones_like(TIP))
    nothing = still | {"tracks": np.zeros((96, 1, 3)), "owners": np.zeros((1, 2))}
    for seen in (still, nothing):
        assert body_shown(seen, T, R, 2).found is False and body_shown(seen, T, R, 2).code is None
        assert body_shown(seen | {"cost": np.array([96, 1, 0, 0, 1.0])}, T, R, 2).found is None
    assert momentum_shown(nothing, T, R, L).found is None


@pytest.mark.parametrize("stride", [2, 7, 9])
def test_every_so_many_samples(stride):
    assert body_shown(watched(TIP[::stride]), T, R, 2).found is True


def test_held_at_the_end_and_begun_anew():
    for order in (np.minimum(np.arange(120), 95), np.arange(150) % 96):
        assert body_shown(watched(TIP[order], at=np.arange(len(order))), T, R, 2).found is True


def test_a_few_frames_show_nothing():
    assert body_shown(line(np.random.default_rng(4).normal(size=(3, 3))), T, R, 2).found is False
    part = body_shown(watched(TIP[:9]), T, R, 2)
    assert part.found is False and "too short" in part.sentence


def test_forged_arrays_are_no_fault():
    good = line(TIP)
    for forged in ({"owners": np.zeros((5, 2))}, {"at": np.zeros((3, 3))}, {"tracks": np.full((96, 2, 3), 1e200)}):
        assert body_shown(good | forged, T, R, 2).found is False
        assert momentum_shown(good | forged, T, R, L).found is None


def test_a_box_seen_from_elsewhere():
    edges = np.stack([R @ corner for corner in ([1, 0.7, 0.2], [-1, 0.7, 0.2], [-1, -0.7, 0.2])])
    seen = watched(*[(e @ VIEW.T)[:, :2] for e in edges], dimensions=2)
    seen["owners"][:, 0] = 0
    assert body_shown(seen, T, R, None).found is True


def test_momentum():
    fixed = np.tile(L / np.linalg.norm(L), (96, 1))
    assert momentum_shown(line(fixed), T, R, L).found is True
    for moving in (R @ L, np.einsum("fji,j->fi", R, L)):
        assert momentum_shown(line(moving), T, R, L).code == "moving-angular-momentum"
    assert momentum_shown(line(TIP), T, R, L).found is None
    flat = watched(fixed[:, [0, 2]], dimensions=2)
    assert momentum_shown(flat, T, R, L).found is True
    short = watched(TIP[::8, :2] * 1.0, dimensions=2)
    assert momentum_shown(short, T, R, L).found is not False, "a short arc accuses nobody"
