"""Drawings of a box: from any side, with its corners in any order, and the wrong ones."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from polhode.kinds.animation.body import Body, body_shown
from polhode.report.figure_parts import box_polys
from tests.support.recordings import (
    ALL,
    BOX,
    CABINET,
    CORNERS,
    HALF,
    ISOMETRIC,
    SPACE,
    TUMBLE,
    UNIT,
    VIEW,
    XY,
    L,
    N,
    R,
    T,
    frames,
    line,
)


def painted_faces(attitudes, camera, eye=None, seed=0):
    """What the driver brings of faces in any order; with ``eye`` (3,) of those that are turned to it
    alone.
    """
    draws = np.random.default_rng(seed)
    sets = []
    for attitude in attitudes:
        faces = [face for face in box_polys(attitude, HALF) if eye is None or face.mean(axis=0) @ eye > 0]
        seen = np.unique(np.concatenate(faces), axis=0)
        sets.append(
            draws.permutation(np.concatenate([seen, np.repeat(seen[:1], 8 - len(seen), axis=0)])) @ camera.T
        )
    drawn = frames(list(np.swapaxes(sets, 0, 1)))
    loose = drawn["owners"] * [1, -1, 1] + [1, 0, 0]
    few = {"tracks": np.concatenate([drawn["tracks"][:, :2], drawn["tracks"]], axis=1)}
    return drawn | few | {"owners": np.concatenate([drawn["owners"][:2], loose])}


EYE = np.cross(*ISOMETRIC)


@pytest.mark.parametrize("camera", [np.eye(3), VIEW, XY, ISOMETRIC], ids=str)
@pytest.mark.parametrize("axis", [None, 2])
def test_a_box_seen_from_anywhere(camera, axis):
    attitudes = TUMBLE if axis is None else R
    box = np.einsum("ia,fab,cb->cfi", camera, attitudes, CORNERS)
    own = len(camera) == 2 and axis == 2 and camera is ISOMETRIC
    arrow = [line(np.tile(camera @ UNIT, (N, 1)))] if own else []
    assert (
        body_shown(frames(list(box), *arrow), Body(T, attitudes, axis, None if axis is None else L)).found
        is True
    )


@pytest.mark.parametrize(
    ("attitudes", "code"),
    [
        (np.swapaxes(TUMBLE, 1, 2), "transposed-rotation"),
        (TUMBLE[::-1], "wrong-motion"),
        (TUMBLE[2 * ALL % 96], "wrong-frames"),
        (TUMBLE[ALL // 3], "wrong-frames"),
        (Rotation.from_rotvec(np.outer(3 * T, [0, 0, 1])).as_matrix(), "wrong-motion"),
    ],
    ids=["transposed", "backwards", "twice", "a third", "about z"],
)
def test_wrong_boxes(attitudes, code):
    box = np.einsum("fab,cb->cfa", attitudes, CORNERS)
    shown = body_shown(frames(list(box)), Body(T, TUMBLE))
    assert shown.found is False and shown.code == code, shown


@pytest.mark.parametrize(
    "camera",
    [
        SPACE,
        XY,
        pytest.param(ISOMETRIC, marks=pytest.mark.slow),
        pytest.param(CABINET, marks=pytest.mark.slow),
    ],
    ids=["3d", "xy", "isometric", "cabinet"],
)
def test_faces_in_any_order(camera):
    shown = body_shown(painted_faces(TUMBLE, camera), BOX)
    assert shown.found is True, shown
    assert body_shown(painted_faces(TUMBLE[::-1], camera), BOX).found is False


def test_faces_in_any_order_show_the_coordinates_that_the_labels_name():
    seen = painted_faces(TUMBLE, SPACE[[2, 0]])
    assert body_shown(seen | {"labels": np.array([[0.0, 2, 0]])}, BOX).found is True
    shown = body_shown(seen | {"labels": np.array([[0.0, 0, 2]])}, BOX)
    assert shown.code == "mirrored" and "axes labelled x and z show z and x" in shown.sentence


def test_only_the_faces_that_are_seen():
    assert body_shown(painted_faces(TUMBLE, ISOMETRIC, EYE), BOX).found is True
    assert body_shown(painted_faces(TUMBLE, ISOMETRIC, EYE), Body(T, TUMBLE, half=HALF[::-1])).found is False
    transposed = body_shown(painted_faces(np.swapaxes(TUMBLE, 1, 2), SPACE), BOX)
    assert transposed.code == "transposed-rotation"


@pytest.mark.parametrize("camera", [SPACE, VIEW, XY], ids=["3d", "turned", "xy"])
def test_a_box_has_the_given_proportions_and_another_body_any(camera):
    def shown(corners):
        return body_shown(frames(list(np.einsum("ia,fab,cb->cfi", camera, TUMBLE, corners))), BOX)

    swapped = shown(CORNERS[:, ::-1])
    assert (
        swapped.code == "wrong-proportions"
        and "0.2 : 0.7 : 1, but half has 1 : 0.7 : 0.2" in swapped.sentence
    )
    assert shown(3 * CORNERS).found is True and shown(np.eye(3)).found is True
    assert (
        shown(np.array([[1, 0.2, 0.1], [-0.3, 0.8, 0.1], [0.2, 0.3, -0.9], [-0.9, 0.1, 0.4]])).found is True
    )


@pytest.mark.parametrize(
    "camera",
    [SPACE, VIEW, XY, pytest.param(ISOMETRIC, marks=pytest.mark.slow)],
    ids=["3d", "turned", "xy", "isometric"],
)
def test_a_box_turns_about_its_centre_with_its_edges_along_the_body_axes(camera):
    def shown(corners, *more, place=(0, 0, 0), edges=False):
        drawn = np.einsum("ia,cfa->cfi", camera, np.einsum("fab,cb->cfa", TUMBLE, corners) + place)
        artists = [[drawn[i], drawn[j]] for i in range(8) for j in range(i)] if edges else [list(drawn)]
        return body_shown(frames(*artists, *more), BOX)

    for aside in (HALF, [0, 0, HALF[2]], [2, 0, 0]):
        wrong = shown(0.8 * (CORNERS + aside))
        own = camera is VIEW or camera is ISOMETRIC  # found from points that all move
        assert wrong.code == "wrong-motion" and ("a point other than its centre" in wrong.sentence or own), (
            wrong
        )
    assert shown(CORNERS + HALF, edges=True).found is False
    for turned in (CORNERS @ TUMBLE[0], CORNERS @ VIEW):
        wrong = shown(turned)
        assert wrong.code == "wrong-motion" and "not along the axes of the body" in wrong.sentence, wrong
    assert shown(0.8 * CORNERS, place=(2, -1, 3)).found is True and shown(CORNERS, edges=True).found is True
    beside = np.concatenate([CORNERS, 0.2 * CORNERS + [1.2, 0, 0]])
    assert shown(beside).found is True, "another body"
    apart = list(np.einsum("ia,fab,cb->cfi", camera, TUMBLE, 0.2 * CORNERS + [1.2, 0, 0]))
    assert shown(CORNERS, apart).found is True, "a smaller box on the box"


def test_a_turned_picture_of_a_turn_about_one_axis():
    turning = Rotation.from_rotvec(np.outer(3 * T, [0.6, 0, 0.8])).as_matrix() @ VIEW
    camera = Rotation.from_rotvec([0.6, 0, 0.8]).as_matrix()
    box = np.einsum("ia,fab,cb->cfi", camera, turning, CORNERS)
    assert body_shown(frames(list(box)), Body(T, turning, half=HALF)).found is True


@pytest.mark.parametrize("mirror", [np.diag([1, -1, 1]), np.eye(3)[[1, 0, 2]]], ids=["y", "swapped"])
def test_a_mirrored_box_is_not_judged(mirror):
    box = np.einsum("ia,fab,cb->cfi", mirror, TUMBLE, CORNERS)
    shown = body_shown(frames(list(box)), BOX)
    assert shown.found is None and "mirror image" in shown.sentence
    upright = np.einsum("ia,fab,cb->cfi", np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]), TUMBLE, CORNERS)
    assert body_shown(frames(list(upright)), BOX).found is True
