"""Paths of drawn points beside the motion: in any style and at any frame rate, and the wrong ones told apart."""

import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import reference
from ecp.draw import box_polys
from exercises.rigid_body.public.animation_checks import body_shown
from exercises.rigid_body.public.momentum import momentum_shown
from exercises.rigid_body.scenes import SCENES, TILT

FILM = next(scene for scene in SCENES if scene.name == "film")
T, R, L = (np.array(FILM.inputs[name]) for name in ("t", "R", "L"))
UNIT = L / np.linalg.norm(L)
N = len(T)
ALL = np.arange(N)
TUMBLE = np.array(next(scene for scene in SCENES if scene.name == "tumble-film").inputs["R"])
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
    """Several of these as the axes of one figure, with the ``labels`` of some: (axes, horizontal, vertical)."""
    owners = [one["owners"] + [100 * k, 0, k] for k, one in enumerate(drawn)]
    together = {"tracks": np.concatenate([one["tracks"] for one in drawn], axis=1), "owners": np.concatenate(owners)}
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


TIP = R[:, :, 2]
CORNER = R @ np.array([1.0, 0.7, 0.2])


@pytest.mark.parametrize(
    "seen",
    [
        watched(TIP),
        watched(0.8 * TIP + [1.0, 2.0, 3.0]),
        frames(line(TIP)),
        frames(line(TIP @ VIEW.T)),
        watched(CORNER, R @ np.array([-1.0, 0.7, 0.2])),
        watched(TIP[:, :2]),
        watched(TIP[:, [2, 0]] * 3.0),
        frames(line(TIP, tail=[2.0, 1.0, 0.0])),
        frames([TIP, -TIP]),
        frames([np.tile(TIP[0], (N, 1)), TIP]),
        watched(R[:, :, 0], R[:, :, 1]),
        watched(TIP[::2]),
        watched(TIP + 0.005 * np.random.default_rng(2).normal(size=TIP.shape)),
    ],
    ids=["tip", "scaled", "line", "turned", "body", "plane", "other plane", "foot", "rod", "trail", "disc", "half", "shaky"],
)
def test_right_drawings(seen):
    shown = body_shown(seen, T, R, 2, L)
    assert shown.found is True, shown


OBLIQUE = R @ R[0].T @ [0.0, 0.0, 1.0]  # along z at the start, whatever R(0) is
RIM = [R @ [0.4 * np.cos(a), 0.4 * np.sin(a), 0.5] for a in (0.0, 1.3, 2.9, 4.1)]
ASKEW = [R @ R[0].T @ [0.4 * np.cos(a), 0.4 * np.sin(a), 0.5] for a in (0.0, 1.3, 2.9, 4.1)]


def test_a_line_that_is_not_the_axis_needs_something_beside_it_that_shows_the_axis():
    shown = body_shown(frames(line(OBLIQUE), ASKEW), T, R, 2, L)
    assert shown.found is False and shown.code == "wrong-axis" and "of the body, not ê₃" in shown.sentence
    assert body_shown(frames(line(OBLIQUE), RIM), T, R, 2, L).found is True, "a disc across the axis"
    assert body_shown(frames(line(OBLIQUE), [CORNER, CORNER + TIP]), T, R, 2, L).found is True, "an edge along the axis"
    assert body_shown(frames(ASKEW), T, R, 2, L).found is True, "a body of any shape"


@pytest.mark.parametrize("camera", [np.eye(3), VIEW, XY, XZ, YX, ISOMETRIC, CABINET, -XY], ids=str)
def test_one_camera_for_the_axis_and_for_L(camera):
    seen = scene(TIP, camera=camera)
    assert body_shown(seen, T, R, 2, L).found is True
    assert momentum_shown(seen, T, R, L).found is True
    reversed_ = scene(TIP, L=-UNIT, camera=camera)
    assert not (body_shown(reversed_, T, R, 2, L).found and momentum_shown(reversed_, T, R, L).found)


def played(total, way):
    """The sample that each of ``total`` frames shows, with fractions where the student interpolates."""
    k = np.arange(total)
    return {
        "rounded down": lambda: np.linspace(0, N - 1, total).astype(int),
        "rounded": lambda: np.rint(np.linspace(0, N - 1, total)).astype(int),
        "share": lambda: k * N // total,
        "clipped": lambda: np.minimum(np.ceil(k * N / total).astype(int), N - 1),
        "every so many": lambda: np.arange(0, N, max(1, N // total)),
        "resampled": lambda: np.linspace(0, N - 1, total),
        "without the end": lambda: np.linspace(0, N - 1, total, endpoint=False),
    }[way]()


WAYS = ("rounded down", "rounded", "share", "clipped", "every so many", "resampled", "without the end")


def interpolated(samples):
    """ê₃ (f, 3) as a student would interpolate it."""
    return np.column_stack([np.interp(samples, ALL, TIP[:, k]) for k in range(3)])


def assert_every_frame_rate_passes(totals):
    refused = []
    for total in totals:
        for way in WAYS:
            samples = played(total, way)
            for camera, values in ((np.eye(3), None), (XY, samples)):
                shown = body_shown(scene(interpolated(samples), camera=camera, values=values), T, R, 2, L)
                refused += [] if shown.found else [(total, way, shown.sentence)]
    assert refused == []


@pytest.mark.slow
def test_any_number_of_frames():
    assert_every_frame_rate_passes((10, 11, 17, 30, 37, 50, 95, 97, 150, 193, 600))


@pytest.mark.exhaustive
def test_every_number_of_frames():
    assert_every_frame_rate_passes(range(10, 601))


def test_held_at_the_end_and_begun_anew():
    for order in (np.minimum(np.arange(120), 95), np.arange(150) % 96):
        assert body_shown(watched(TIP[order]), T, R, 2, L).found is True


def test_frame_values_of_uneven_steps():
    order = np.unique(np.rint(95 * np.linspace(0, 1, 60) ** 2).astype(int))
    assert body_shown(watched(TIP[order]), T, R, 2, L).found is False
    shown = body_shown(frames([TIP[order]], values=order), T, R, 2, L)
    assert shown.found is False and "mistimed: frame" in shown.sentence, shown
    even = np.r_[0:N:4, [N - 1] * 5]
    assert body_shown(frames([TIP[even]], values=even), T, R, 2, L).found is True
    assert body_shown(frames([TIP[even]], values=T[even]), T, R, 2, L).found is True
    assert body_shown(frames([TIP[order]], values=T[order]), T, R, 2, L).found is False


def test_frame_values_that_count_down_run_backwards():
    shown = body_shown(scene(TIP[::-1], values=ALL[::-1]), T, R, 2, L)
    assert shown.found is False and "backwards in time" in shown.sentence
    there_and_back = np.r_[ALL[::2], ALL[::-2]]
    shown = body_shown(scene(TIP[there_and_back], values=there_and_back), T, R, 2, L)
    assert shown.found is False and "backwards from frame" in shown.sentence, shown
    twice = np.tile(ALL[::2], 2)
    assert body_shown(scene(TIP[twice], values=twice), T, R, 2, L).found is True


def test_a_few_wrong_frames_are_wrong():
    total = 400
    tips = interpolated(np.linspace(0, N - 1, total))
    assert body_shown(scene(tips), T, R, 2, L).found is True
    astray = tips.copy()
    astray[201:204] = 2 * (tips @ UNIT)[201:204, None] * UNIT - tips[201:204]  # across the cone
    shown = body_shown(scene(astray), T, R, 2, L)
    assert shown.found is False and re.search("frame 20[1-3] of 400 shows sample", shown.sentence), shown


def test_a_part_that_shows_a_full_turn_passes_and_is_said():
    for part in (ALL[:70], ALL[20:90]):
        shown = body_shown(scene(TIP[part]), T, R, 2, L)
        assert shown.found is True and f"samples {part[0]}–{part[-1]} of 96" in shown.sentence


WRONG = {
    "e1": (R[:, :, 0], "wrong-axis", "follows ê₁, not ê₃"),
    "e2": (R[:, :, 1], "wrong-axis", "follows ê₂, not ê₃"),
    "minus": (-TIP, "wrong-axis", "follows −ê₃, not ê₃"),
    "other": (R @ np.array([0.6, 0.0, 0.8]), "wrong-axis", "the direction (0.60, 0.00, 0.80) of the body"),
    "R L": (R @ UNIT, "moving-angular-momentum", "the drawing shows R·L"),
    "transposed": (R[:, 2, :], "transposed-rotation", "transposed R"),
    "omega": (L / 1.25 - 0.3 * TIP, "wrong-motion", "follows ω"),
    "backwards": (TIP[::-1], "wrong-motion", "backwards in time"),
    "noise": (np.random.default_rng(3).normal(size=TIP.shape), "wrong-motion", "nothing that moves follows the body"),
    "about z": (np.column_stack([np.cos(3 * T), np.sin(3 * T), 0.5 + 0 * T]), "wrong-motion", ""),
    "swapped": (TIP[:, [1, 0, 2]], "mirrored", "x and y are swapped"),
    "mirrored": (TIP * [1, -1, 1], "mirrored", "the sign of a coordinate is wrong"),
    "cyclic": (TIP[:, [1, 2, 0]], "mirrored", "other coordinates than L"),
    "turned": (TIP @ Rotation.from_rotvec(0.7 * UNIT).as_matrix().T, "wrong-frames", "samples are mistimed"),
    "shifted": (TIP + [0, 0.2, 0.4], "wrong-motion", "nothing that moves follows the body"),
    "first ten": (TIP[ALL % 10], "wrong-frames", "shows only samples 0–9 of 96 repeatedly"),
    "first tenth": (TIP[ALL // 10], "wrong-frames", "shows only samples 0–9 of 96"),
    "half speed": (TIP[ALL // 2], "wrong-frames", "shows only samples 0–47 of 96"),
    "double speed": (TIP[np.minimum(2 * ALL, 95)], "wrong-frames", "already shows sample 95 of 96, and later frames do not change"),
    "twice": (TIP[2 * ALL % 96], "wrong-frames", "begins again after frame"),
    "late": (TIP[(ALL + 40) % 96], "wrong-frames", "begins again after frame"),
    "shuffled": (TIP[np.random.default_rng(0).permutation(96)], "wrong-frames", "its samples are mistimed: frame"),
}
FLAT = {"mirrored", "swapped", "cyclic"}


@pytest.mark.parametrize("camera", [np.eye(3), XY, XZ], ids=["3d", "xy", "xz"])
@pytest.mark.parametrize("name", WRONG)
def test_wrong_drawings(name, camera):
    tip, code, sentence = WRONG[name]
    seen = frames(line(tip @ camera.T), line(np.tile(camera @ UNIT, (N, 1))))
    shown = body_shown(seen, T, R, 2, L)
    if name in ("mirrored", "shifted") and len(camera) == 2 and np.array_equal(tip @ camera.T, TIP @ camera.T):
        assert shown.found is True, "what is wrong is not to be seen in this plane"
    else:
        assert shown.found is False and shown.code == code, shown
        assert sentence in shown.sentence or (name in FLAT and "coordinates" in shown.sentence), shown.sentence


@pytest.mark.parametrize(
    "name", ["double speed", "twice", "half speed", "first ten", "e1", "R L", "transposed", "omega", "shuffled", "late"]
)
def test_wrong_drawings_by_the_students_own_camera(name):
    tip, code, _ = WRONG[name]
    shown = body_shown(scene(tip, camera=ISOMETRIC), T, R, 2, L)
    assert shown.found is False and shown.code in (code, "wrong-motion"), shown


def test_a_view_that_nothing_confirms_is_not_judged():
    shown = body_shown(scene(TIP, camera=ISOMETRIC, momentum=False), T, R, 2, L)
    assert shown.found is None and "draw L" in shown.sentence
    opposite = body_shown(scene(-TIP, camera=ISOMETRIC @ np.eye(3)), T, R, 2, L)
    assert opposite.found is False and "opposite sides" in opposite.sentence


def test_what_stands_still_is_not_the_body_unless_a_picture_is_painted():
    still = watched(np.ones_like(TIP))
    nothing = still | {"tracks": np.zeros((N, 1, 3)), "owners": np.zeros((1, 3))}
    for seen in (still, nothing):
        assert body_shown(seen, T, R, 2, L).found is False
        assert body_shown(seen, T, R, 2, L).code == ("static" if seen is still else None)
        assert body_shown(seen | {"cost": np.array([96, 1, 0, 0, 1.0])}, T, R, 2, L).found is None
    assert momentum_shown(nothing, T, R, L).found is None


def test_what_cannot_be_seen_is_static():
    nothing = watched(np.ones_like(TIP)) | {"visible": np.array([0.0, 1.0])}
    shown = body_shown(nothing, T, R, 2, L)
    assert shown.found is False and shown.code == "static" and "nothing that moves can be seen: " in shown.sentence
    wrong = body_shown(scene(R[:, :, 0]) | {"visible": np.array([0.1, 1.0])}, T, R, 2, L)
    assert wrong.found is False and "artists that cannot be seen do not count" in wrong.sentence
    assert body_shown(scene(TIP) | {"visible": np.array([0.1, 1.0])}, T, R, 2, L).found is True


def test_what_changes_once_is_static():
    seldom = body_shown(scene(TIP[[0] + (N - 1) * [N - 1]]), T, R, 2, L)
    assert seldom.found is False and seldom.code == "static" and "at only 1 of 96 frames" in seldom.sentence, seldom
    assert body_shown(scene(TIP * [1, 1, 0] + [0, 0, 0.3]), T, R, 2, L).code != "static"


def test_a_few_frames_show_nothing():
    few = body_shown(watched(TIP[::12]), T, R, 2, L)
    assert few.found is False and "too short" in few.sentence
    part = body_shown(watched(TIP[:12]), T, R, 2, L)
    assert part.found is False and "only samples 0–11 of 96" in part.sentence


def test_forged_arrays_are_no_fault():
    good = scene(TIP)
    for forged in ({"owners": np.zeros((5, 3))}, {"at": np.zeros((3, 3))}, {"tracks": np.full((N, 4, 3), 1e200)}):
        assert body_shown(good | forged, T, R, 2, L).found is False
        assert momentum_shown(good | forged, T, R, L).found is None
    rng = np.random.default_rng(5)
    for scale in (1e-300, 1.0, 1e90):
        wild = {"tracks": scale * rng.normal(size=(N, 4, 3)), "at": np.abs(scale * rng.normal(size=(N, 3))) + 1}
        assert body_shown(good | wild, T, R, 2, L).found is not True
        assert momentum_shown(good | wild, T, R, L).found is not True


CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-0.7, 0.7) for z in (-0.2, 0.2)])


@pytest.mark.parametrize("camera", [np.eye(3), VIEW, XY, ISOMETRIC], ids=str)
@pytest.mark.parametrize("axis", [None, 2])
def test_a_box_seen_from_anywhere(camera, axis):
    attitudes = TUMBLE if axis is None else R
    box = np.einsum("ia,fab,cb->cfi", camera, attitudes, CORNERS)
    own = len(camera) == 2 and axis == 2 and camera is ISOMETRIC
    arrow = [line(np.tile(camera @ UNIT, (N, 1)))] if own else []
    assert body_shown(frames(list(box), *arrow), T, attitudes, axis, None if axis is None else L).found is True


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
    shown = body_shown(frames(list(box)), T, TUMBLE, None)
    assert shown.found is False and shown.code == code, shown


HALF = np.array([1.0, 0.7, 0.2])


def painted_faces(attitudes, camera, eye=None, seed=0):
    """What the driver brings of faces in any order; with ``eye`` (3,) of those that are turned to it alone."""
    draws = np.random.default_rng(seed)
    sets = []
    for attitude in attitudes:
        faces = [face for face in box_polys(attitude, HALF) if eye is None or face.mean(axis=0) @ eye > 0]
        seen = np.unique(np.concatenate(faces), axis=0)
        sets.append(draws.permutation(np.concatenate([seen, np.repeat(seen[:1], 8 - len(seen), axis=0)])) @ camera.T)
    drawn = frames(list(np.swapaxes(sets, 0, 1)))
    loose = drawn["owners"] * [1, -1, 1] + [1, 0, 0]
    few = {"tracks": np.concatenate([drawn["tracks"][:, :2], drawn["tracks"]], axis=1)}
    return drawn | few | {"owners": np.concatenate([drawn["owners"][:2], loose])}


EYE = np.cross(*ISOMETRIC)


@pytest.mark.parametrize("camera", [SPACE, XY, ISOMETRIC, CABINET], ids=["3d", "xy", "isometric", "cabinet"])
def test_faces_in_any_order(camera):
    shown = body_shown(painted_faces(TUMBLE, camera), T, TUMBLE, None, half=HALF)
    assert shown.found is True, shown
    assert body_shown(painted_faces(TUMBLE[::-1], camera), T, TUMBLE, None, half=HALF).found is False


def test_only_the_faces_that_are_seen():
    assert body_shown(painted_faces(TUMBLE, ISOMETRIC, EYE), T, TUMBLE, None, half=HALF).found is True
    assert body_shown(painted_faces(TUMBLE, ISOMETRIC, EYE), T, TUMBLE, None, half=HALF[::-1]).found is False
    transposed = body_shown(painted_faces(np.swapaxes(TUMBLE, 1, 2), SPACE), T, TUMBLE, None, half=HALF)
    assert transposed.code == "transposed-rotation"


@pytest.mark.parametrize("camera", [SPACE, VIEW, XY], ids=["3d", "turned", "xy"])
def test_a_box_has_the_given_proportions_and_another_body_any(camera):
    def shown(corners):
        return body_shown(frames(list(np.einsum("ia,fab,cb->cfi", camera, TUMBLE, corners))), T, TUMBLE, None, half=HALF)

    swapped = shown(CORNERS[:, ::-1])
    assert swapped.code == "wrong-proportions" and "0.2 : 0.7 : 1, but half has 1 : 0.7 : 0.2" in swapped.sentence
    assert shown(3 * CORNERS).found is True and shown(np.eye(3)).found is True
    assert shown(np.array([[1, 0.2, 0.1], [-0.3, 0.8, 0.1], [0.2, 0.3, -0.9], [-0.9, 0.1, 0.4]])).found is True


@pytest.mark.parametrize(
    "camera", [SPACE, VIEW, XY, pytest.param(ISOMETRIC, marks=pytest.mark.slow)], ids=["3d", "turned", "xy", "isometric"]
)
def test_a_box_turns_about_its_centre_with_its_edges_along_the_body_axes(camera):
    def shown(corners, *more, place=(0, 0, 0), edges=False):
        drawn = np.einsum("ia,cfa->cfi", camera, np.einsum("fab,cb->cfa", TUMBLE, corners) + place)
        artists = [[drawn[i], drawn[j]] for i in range(8) for j in range(i)] if edges else [list(drawn)]
        return body_shown(frames(*artists, *more), T, TUMBLE, None, half=HALF)

    for aside in (HALF, [0, 0, HALF[2]], [2, 0, 0]):
        wrong = shown(0.8 * (CORNERS + aside))
        own = camera is VIEW or camera is ISOMETRIC  # found from points that all move
        assert wrong.code == "wrong-motion" and ("a point other than its centre" in wrong.sentence or own), wrong
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
    assert body_shown(frames(list(box)), T, turning, None, half=HALF).found is True


@pytest.mark.parametrize("mirror", [np.diag([1, -1, 1]), np.eye(3)[[1, 0, 2]]], ids=["y", "swapped"])
def test_a_mirrored_box_is_not_judged(mirror):
    box = np.einsum("ia,fab,cb->cfi", mirror, TUMBLE, CORNERS)
    shown = body_shown(frames(list(box)), T, TUMBLE, None, half=HALF)
    assert shown.found is None and "mirror image" in shown.sentence
    upright = np.einsum("ia,fab,cb->cfi", np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]), TUMBLE, CORNERS)
    assert body_shown(frames(list(upright)), T, TUMBLE, None, half=HALF).found is True


def test_momentum():
    fixed = np.tile(UNIT, (N, 1))
    assert momentum_shown(frames(line(TIP), line(fixed)), T, R, L).found is True
    for moving in (R @ UNIT, np.einsum("fji,j->fi", R, UNIT)):
        assert momentum_shown(frames(line(TIP), line(moving)), T, R, L).code == "moving-angular-momentum"
    missing = momentum_shown(frames(line(TIP)), T, R, L)
    assert missing.found is None and "draw L" in missing.sentence
    assert momentum_shown(frames(line(TIP), line(-fixed)), T, R, L).code == "reversed-angular-momentum"
    assert momentum_shown(frames(line(TIP), [fixed, 0 * fixed]), T, R, L).found is True, "a line drawn from its tip"
    from_tip = momentum_shown(frames(line(TIP), [-fixed, 0 * fixed]), T, R, L)
    assert from_tip.code == "reversed-angular-momentum", "as quiver lists its points"
    assert momentum_shown(frames(line(TIP), [-fixed, fixed]), T, R, L).found is True, "a line to both sides"
    flat = frames(line(TIP[:, [0, 2]]), line(fixed[:, [0, 2]]))
    assert momentum_shown(flat, T, R, L).found is True
    short = watched(TIP[::8, :2] * 1.0)
    assert momentum_shown(short, T, R, L).found is not False, "a short arc accuses nobody"


ACROSS = np.linalg.svd(UNIT[None])[2][1:]  # two directions across L: a view along it


def test_L_seen_end_on_is_a_point():
    tip, centre = TIP @ ACROSS.T, np.zeros((N, 2))
    assert momentum_shown(frames(line(tip)), T, R, L).found is True
    assert momentum_shown(frames(line(tip), [centre]), T, R, L).found is True
    aside = frames([tip + [0.3, 0.1]], [centre])
    assert momentum_shown(aside, T, R, L).found is None


@pytest.mark.parametrize(
    ("direction", "sentence"),
    [
        (np.eye(3)[2], "a fixed line points along z"),
        (R[0].T @ UNIT, "uses the body components of L"),
        (np.array([0.6, 0.0, 0.8]), "the only fixed line points along (0.60, 0.00, 0.80)"),
    ],
)
def test_a_fixed_line_that_is_not_L(direction, sentence):
    shown = momentum_shown(frames(line(TIP), line(np.tile(direction, (N, 1)))), T, R, L)
    assert shown.found is None and shown.code == "wrong-angular-momentum" and sentence in shown.sentence
    head = [direction * 0.9 + 0.1 * side for side in np.linalg.svd(direction[None])[2][1:]]
    arrow = [np.tile(point, (N, 1)) for point in (0 * direction, direction, *head)]
    assert sentence in momentum_shown(frames(line(TIP), arrow), T, R, L).sentence
    axes_too = frames(line(TIP), *(line(np.tile(axis, (N, 1))) for axis in np.eye(3)))
    assert momentum_shown(axes_too, T, R, L).code is None, "axes of coordinates are not meant as L"
    camera = np.array([[-0.6, 0.8, 0], [-0.3, -0.2, 0.9]])  # z is drawn upwards, as the second axis of the paper
    flat = frames(line(TIP @ camera[:, ::-1].T), *(line(np.tile(axis, (N, 1))) for axis in [*camera.T, camera @ UNIT]))
    assert momentum_shown(flat, T, R, L).code is None, "one of several lines is not meant as L"


def test_drawn_in_the_axes_of_the_body():
    moving, still = np.einsum("fji,j->fi", R, UNIT), [line(np.tile(axis, (N, 1))) for axis in np.eye(3)]
    assert "drawn in body axes" in momentum_shown(frames(line(moving), *still), T, R, L).sentence


def cone(angle):
    """Unit vectors (f, 3) that turn with ê₃ about L at another ``angle``."""
    across = TIP - np.outer(TIP @ UNIT, UNIT)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    return np.cos(angle) * UNIT + np.sin(angle) * across


ALMOST = {
    "narrow": (cone(0.5), "on a cone of 29° about L"),
    "wide": (cone(1.4), "on a cone of 80° about L"),  # its tip alone is a scaled and shifted ê₃
    "about z": (np.column_stack([np.cos(3 * T), np.sin(3 * T), 0.5 + 0 * T]), "the z coordinate of the drawing is constant"),
    "level": (TIP * [1, 1, 0] + [0, 0, TIP[0, 2]], "the z coordinate of the drawing is constant"),
    "noise": (TIP + 0.05 * np.random.default_rng(4).normal(size=TIP.shape), "scatters about its path"),
    "twice": (TIP[2 * ALL % 96], "runs twice as fast and begins again"),
    "omega": (L / 1.25 - 0.3 * TIP, "follows ω"),
    "omega, unit": ((L / 1.25 - 0.3 * TIP) / np.linalg.norm(L / 1.25 - 0.3 * TIP, axis=1)[:, None], "follows ω"),
}


@pytest.mark.parametrize("name", ALMOST)
def test_what_resembles_the_axis_is_named(name):
    tip, sentence = ALMOST[name]
    shown = body_shown(frames(line(tip), [np.tile(tip[0], (N, 1)), tip], line(np.tile(UNIT, (N, 1)))), T, R, 2, L)
    assert shown.found is False and sentence in shown.sentence, shown


def test_the_scene_starts_away_from_every_axis_and_plane():
    assert np.abs(UNIT).min() > 0.1 and np.abs(TIP[0]).min() > 0.1
    assert TIP.min(axis=0).max() < -0.1 and TIP.max(axis=0).min() > 0.1, "the axis crosses each coordinate plane"
    exact = reference.motion((2.2, 0.0, 0.5), (1.25, 1.25, 2.0), T, need="orientation").R
    assert np.allclose(R, TILT @ exact)


def test_axes_labelled_with_two_coordinates_show_these():
    both = panels(scene(TIP, camera=XY), scene(TIP, camera=XZ), labels=[(0, 0, 1), (1, 0, 2)])
    assert body_shown(both, T, R, 2, L).found and momentum_shown(both, T, R, L).found
    for wrong, said in ((XY, "axes labelled x and z show x and y"), (XZ[::-1], "axes labelled x and z show z and x")):
        shown = body_shown(panels(scene(TIP, camera=XY), scene(TIP, camera=wrong), labels=[(0, 0, 1), (1, 0, 2)]), T, R, 2, L)
        assert (shown.found, shown.code) == (False, "mirrored") and said in shown.sentence
    assert body_shown(panels(scene(TIP, camera=XY), scene(TIP, camera=XZ[::-1])), T, R, 2, L).found, "without labels"
    assert body_shown(panels(scene(TIP, camera=XZ), labels=[(0, -1, 2)]), T, R, 2, L).found, "one label alone"


def test_axes_beside_right_ones_may_show_something_else_but_no_axis_at_wrong_times():
    moment = np.column_stack([T, np.zeros(N)])
    angle = np.column_stack([T, np.degrees(np.arccos(TIP @ UNIT)), 0 * T])[:, :2]
    in_the_body = np.einsum("fji,j->fi", R, UNIT)
    for beside in (
        watched(moment, moment + [0, 1]),
        watched(angle),
        scene(in_the_body),
        scene(R[:, :, 0]),
        scene(TIP, camera=VIEW),
    ):
        assert body_shown(panels(scene(TIP), beside), T, R, 2, L).found
    for tip in (TIP[2 * ALL % 96], TIP[ALL // 2], TIP[ALL // 10]):
        shown = body_shown(panels(scene(TIP), scene(tip, camera=XZ)), T, R, 2, L)
        assert (shown.found, shown.code) == (False, "wrong-frames"), shown
        assert shown.sentence.startswith("one of the axes is wrong: ê₃ is drawn, but")


@pytest.mark.parametrize("unit", [1.0, 180 / np.pi], ids=["radians", "degrees"])
def test_polar_axes_may_be_a_map_of_directions(unit):
    def placed(v):
        return unit * np.arccos(v[..., 2:]) * v[..., :2] / np.linalg.norm(v[..., :2], axis=-1, keepdims=True)

    def drawn(tip):
        seen = frames([placed(tip)], [np.tile(placed(UNIT), (len(tip), 1))])
        return seen | {"labels": np.array([[0.0, -2.0, -2.0]])}

    assert body_shown(drawn(TIP), T, R, 2, L).found and momentum_shown(drawn(TIP), T, R, L).found
    assert body_shown(drawn(R[:, :, 0]), T, R, 2, L).found is False
    assert body_shown(drawn(TIP[2 * ALL % 96]), T, R, 2, L).found is False


def test_with_one_frame_for_each_sample_no_part_is_stretched():
    stretched = np.interp(0.7 * ALL, ALL, ALL)
    tip = np.column_stack([np.interp(stretched, ALL, column) for column in TIP.T])
    shown = body_shown(scene(tip), T, R, 2, L)
    assert shown.code == "wrong-frames" and "frame 95 of 96 shows sample 66 of 96" in shown.sentence, shown
    assert body_shown(scene(tip[::2]), T, R, 2, L).found, "a part with a full turn at another number of frames"


def test_what_is_drawn_in_place_of_L_or_stands_still_is_named():
    omega = L / 1.25 - 0.3 * TIP
    shown = momentum_shown(frames(line(TIP), line(omega)), T, R, L)
    assert (shown.found, shown.code) == (False, "moving-angular-momentum") and "follows ω" in shown.sentence
    shown = body_shown(scene(TIP[np.minimum(ALL, 12)]), T, R, 2, L)
    assert shown.code == "wrong-frames" and "from frame 12 of 96 on the picture stands still" in shown.sentence, shown


def test_an_axis_in_perspective():
    def seen(v):
        return (v @ ISOMETRIC.T) / (1 - v @ np.cross(*ISOMETRIC) / 6)[:, None]

    def drawn(tip, L=UNIT):
        return frames(line(seen(tip)), line(np.tile(seen(L[None]), (len(tip), 1))))

    assert body_shown(drawn(TIP), T, R, 2, L).found and momentum_shown(drawn(TIP), T, R, L).found
    for wrong in (drawn(R[:, :, 0]), drawn(TIP, np.eye(3)[2]), drawn(TIP * [1, -1, 1])):
        assert not body_shown(wrong, T, R, 2, L).found or not momentum_shown(wrong, T, R, L).found
