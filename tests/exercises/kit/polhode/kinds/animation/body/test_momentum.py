"""Drawings along the angular momentum: right ones, reversed or moving ones, and other fixed lines."""

import numpy as np
import pytest

from polhode.kinds.animation.body import momentum_shown
from tests.support.recordings import TIP, TOP, UNIT, N, R, frames, line, watched


def test_momentum():
    fixed = np.tile(UNIT, (N, 1))
    assert momentum_shown(frames(line(TIP), line(fixed)), TOP).found is True
    for moving in (R @ UNIT, np.einsum("fji,j->fi", R, UNIT)):
        assert momentum_shown(frames(line(TIP), line(moving)), TOP).code == "moving-angular-momentum"
    missing = momentum_shown(frames(line(TIP)), TOP)
    assert missing.found is None and "draw L" in missing.sentence
    assert momentum_shown(frames(line(TIP), line(-fixed)), TOP).code == "reversed-angular-momentum"
    assert momentum_shown(frames(line(TIP), [fixed, 0 * fixed]), TOP).found is True, (
        "a line drawn from its tip"
    )
    from_tip = momentum_shown(frames(line(TIP), [-fixed, 0 * fixed]), TOP)
    assert from_tip.code == "reversed-angular-momentum", "as quiver lists its points"
    assert momentum_shown(frames(line(TIP), [-fixed, fixed]), TOP).found is True, "a line to both sides"
    flat = frames(line(TIP[:, [0, 2]]), line(fixed[:, [0, 2]]))
    assert momentum_shown(flat, TOP).found is True
    short = watched(TIP[::8, :2] * 1.0)
    assert momentum_shown(short, TOP).found is not False, "a short arc accuses nobody"


ACROSS = np.linalg.svd(UNIT[None])[2][1:]  # two directions across L: a view along it


def test_L_seen_end_on_is_a_point():
    tip, centre = TIP @ ACROSS.T, np.zeros((N, 2))
    assert momentum_shown(frames(line(tip)), TOP).found is True
    assert momentum_shown(frames(line(tip), [centre]), TOP).found is True
    aside = frames([tip + [0.3, 0.1]], [centre])
    assert momentum_shown(aside, TOP).found is None


@pytest.mark.parametrize(
    ("direction", "found", "sentence"),
    [
        (np.eye(3)[2], None, "a fixed line points along z"),
        (R[0].T @ UNIT, False, "uses the body components of L"),
        (np.array([0.6, 0.0, 0.8]), False, "the only fixed line points along (0.60, 0.00, 0.80)"),
    ],
)
def test_a_fixed_line_that_is_not_L_is_wrong_unless_it_is_an_axis_of_coordinates(direction, found, sentence):
    shown = momentum_shown(frames(line(TIP), line(np.tile(direction, (N, 1)))), TOP)
    assert shown.found is found and shown.code == "wrong-angular-momentum" and sentence in shown.sentence
    beside = frames(line(TIP), line(np.tile(direction, (N, 1))), line(np.tile(UNIT, (N, 1))))
    assert momentum_shown(beside, TOP).found is True, "another line may be drawn beside L"
    head = [direction * 0.9 + 0.1 * side for side in np.linalg.svd(direction[None])[2][1:]]
    arrow = [np.tile(point, (N, 1)) for point in (0 * direction, direction, *head)]
    assert sentence in momentum_shown(frames(line(TIP), arrow), TOP).sentence
    axes_too = frames(line(TIP), *(line(np.tile(axis, (N, 1))) for axis in np.eye(3)))
    assert momentum_shown(axes_too, TOP).code is None, "axes of coordinates are not meant as L"
    camera = np.array(
        [[-0.6, 0.8, 0], [-0.3, -0.2, 0.9]]
    )  # z is drawn upwards, as the second axis of the paper
    flat = frames(
        line(TIP @ camera[:, ::-1].T), *(line(np.tile(axis, (N, 1))) for axis in [*camera.T, camera @ UNIT])
    )
    assert momentum_shown(flat, TOP).code is None, "one of several lines is not meant as L"


def test_drawn_in_the_axes_of_the_body():
    moving, still = np.einsum("fji,j->fi", R, UNIT), [line(np.tile(axis, (N, 1))) for axis in np.eye(3)]
    assert "drawn in body axes" in momentum_shown(frames(line(moving), *still), TOP).sentence


def test_a_fixed_line_in_a_plane_may_be_seen_by_a_camera_that_is_not_known():
    flat = frames(line(TIP[:, :2]), line(np.tile([0.6, 0.8], (N, 1))))
    assert momentum_shown(flat, TOP).found is None
