"""Drawings of a body axis: in any style, by any camera and at any frame rate, and the wrong ones named."""

import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from polhode.kinds.animation.body import Body, body_shown, momentum_shown
from tests.support.recordings import (
    ALL,
    CABINET,
    ISOMETRIC,
    SPACE,
    TIP,
    TOP,
    TUMBLE,
    UNIT,
    VIEW,
    XY,
    XZ,
    YX,
    L,
    N,
    R,
    T,
    frames,
    line,
    panels,
    scene,
    watched,
)

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
    ids=[
        "tip",
        "scaled",
        "line",
        "turned",
        "body",
        "plane",
        "other plane",
        "foot",
        "rod",
        "trail",
        "disc",
        "half",
        "shaky",
    ],
)
def test_right_drawings(seen):
    shown = body_shown(seen, TOP)
    assert shown.found is True, shown


OBLIQUE = R @ R[0].T @ [0.0, 0.0, 1.0]  # along z at the start, whatever R(0) is
RIM = [R @ [0.4 * np.cos(a), 0.4 * np.sin(a), 0.5] for a in (0.0, 1.3, 2.9, 4.1)]
ASKEW = [R @ R[0].T @ [0.4 * np.cos(a), 0.4 * np.sin(a), 0.5] for a in (0.0, 1.3, 2.9, 4.1)]


def test_a_line_that_is_not_the_axis_needs_something_beside_it_that_shows_the_axis():
    shown = body_shown(frames(line(OBLIQUE), ASKEW), TOP)
    assert shown.found is False and shown.code == "wrong-axis" and "of the body, not ê₃" in shown.sentence
    assert body_shown(frames(line(OBLIQUE), RIM), TOP).found is True, "a disc across the axis"
    assert body_shown(frames(line(OBLIQUE), [CORNER, CORNER + TIP]), TOP).found is True, (
        "an edge along the axis"
    )
    assert body_shown(frames(ASKEW), TOP).found is True, "a body of any shape"


@pytest.mark.parametrize("camera", [np.eye(3), VIEW, XY, XZ, YX, ISOMETRIC, CABINET, -XY], ids=str)
def test_one_camera_for_the_axis_and_for_L(camera):
    seen = scene(TIP, camera=camera)
    assert body_shown(seen, TOP).found is True
    assert momentum_shown(seen, TOP).found is True
    reversed_ = scene(TIP, L=-UNIT, camera=camera)
    assert not (body_shown(reversed_, TOP).found and momentum_shown(reversed_, TOP).found)


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
                shown = body_shown(scene(interpolated(samples), camera=camera, values=values), TOP)
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
        assert body_shown(watched(TIP[order]), TOP).found is True


@pytest.mark.parametrize(
    ("before", "samples", "after"),
    [
        (30, ALL, 30),
        (12, ALL[::2], 0),
        (0, ALL[::3], 40),
        (25, ALL[1::2], 24),
        (2, np.linspace(0, N - 1, 61), 3),
        (100, ALL, 0),
    ],
)
def test_the_first_and_the_last_picture_may_be_repeated(before, samples, after):
    order = np.r_[[samples[0]] * before, samples, [samples[-1]] * after]
    for values in (order, np.interp(order, ALL, T), -np.ones(len(order))):
        shown = body_shown(frames([interpolated(order)], values=values), TOP)
        assert shown.found is True, shown


def test_an_update_function_may_rest_before_and_after_the_motion():
    for before, moving, after in ((20, 80, 20), (15, N, 20), (0, 60, 15)):
        k = np.arange(before + moving + after) - before
        tips = interpolated(np.clip(k * (N - 1) / (moving - 1), 0, N - 1))
        assert body_shown(watched(tips), TOP).found is True, (before, moving, after)


@pytest.mark.parametrize(
    ("order", "values"),
    [
        (np.r_[ALL[:48], [47] * 30, ALL[48:]], None),  # a pause in the middle
        (np.minimum(2 * ALL, 95), -np.ones(N)),  # held, with one frame for each sample
        (np.r_[[0] * 48, ALL[::2]], ALL),  # late, with one frame for each sample
        (np.r_[[0] * 60, ALL[::2]], np.arange(108)),  # more than a while
        (np.r_[[0] * 30, ALL[::2], ALL[::2]], np.arange(126)),  # a rest does not excuse what follows
        (np.r_[[0] * 30, ALL[::-1]], None),
    ],
    ids=["middle", "held", "late", "long", "twice as fast, twice", "backwards"],
)
def test_other_rests_are_mistimed(order, values):
    shown = body_shown(frames([TIP[order]], values=order if values is None else values), TOP)
    assert shown.found is False, shown


def test_frame_values_of_uneven_steps():
    order = np.unique(np.rint(95 * np.linspace(0, 1, 60) ** 2).astype(int))
    assert body_shown(watched(TIP[order]), TOP).found is False
    shown = body_shown(frames([TIP[order]], values=order), TOP)
    assert shown.found is False and "mistimed: frame" in shown.sentence, shown
    even = np.r_[0:N:4, [N - 1] * 5]
    assert body_shown(frames([TIP[even]], values=even), TOP).found is True
    assert body_shown(frames([TIP[even]], values=T[even]), TOP).found is True
    assert body_shown(frames([TIP[order]], values=T[order]), TOP).found is False


def test_frame_values_that_count_down_run_backwards():
    shown = body_shown(scene(TIP[::-1], values=ALL[::-1]), TOP)
    assert shown.found is False and "backwards in time" in shown.sentence
    there_and_back = np.r_[ALL[::2], ALL[::-2]]
    shown = body_shown(scene(TIP[there_and_back], values=there_and_back), TOP)
    assert shown.found is False and "backwards from frame" in shown.sentence, shown
    twice = np.tile(ALL[::2], 2)
    assert body_shown(scene(TIP[twice], values=twice), TOP).found is True


def test_a_few_wrong_frames_are_wrong():
    total = 400
    tips = interpolated(np.linspace(0, N - 1, total))
    assert body_shown(scene(tips), TOP).found is True
    astray = tips.copy()
    astray[201:204] = 2 * (tips @ UNIT)[201:204, None] * UNIT - tips[201:204]  # across the cone
    shown = body_shown(scene(astray), TOP)
    assert shown.found is False and re.search("frame 20[1-3] of 400 shows sample", shown.sentence), shown


def test_a_part_that_shows_a_full_turn_passes_and_is_said():
    for part in (ALL[:70], ALL[20:90]):
        shown = body_shown(scene(TIP[part]), TOP)
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
    "noise": (
        np.random.default_rng(3).normal(size=TIP.shape),
        "wrong-motion",
        "nothing that moves follows the body",
    ),
    "about z": (np.column_stack([np.cos(3 * T), np.sin(3 * T), 0.5 + 0 * T]), "wrong-motion", ""),
    "swapped": (TIP[:, [1, 0, 2]], "mirrored", "x and y are swapped"),
    "mirrored": (TIP * [1, -1, 1], "mirrored", "the sign of a coordinate is wrong"),
    "cyclic": (TIP[:, [1, 2, 0]], "mirrored", "other coordinates than L"),
    "turned": (TIP @ Rotation.from_rotvec(0.7 * UNIT).as_matrix().T, "wrong-frames", "samples are mistimed"),
    "shifted": (TIP + [0, 0.2, 0.4], "wrong-motion", "nothing that moves follows the body"),
    "first ten": (TIP[ALL % 10], "wrong-frames", "shows only samples 0–9 of 96 repeatedly"),
    "first tenth": (TIP[ALL // 10], "wrong-frames", "shows only samples 0–9 of 96"),
    "half speed": (TIP[ALL // 2], "wrong-frames", "shows only samples 0–47 of 96"),
    "double speed": (
        TIP[np.minimum(2 * ALL, 95)],
        "wrong-frames",
        "already shows sample 95 of 96, and later frames do not change",
    ),
    "twice": (TIP[2 * ALL % 96], "wrong-frames", "begins again after frame"),
    "late": (TIP[(ALL + 40) % 96], "wrong-frames", "begins again after frame"),
    "shuffled": (
        TIP[np.random.default_rng(0).permutation(96)],
        "wrong-frames",
        "its samples are mistimed: frame",
    ),
}
FLAT = {"mirrored", "swapped", "cyclic"}


@pytest.mark.parametrize("camera", [np.eye(3), XY, XZ], ids=["3d", "xy", "xz"])
@pytest.mark.parametrize("name", WRONG)
def test_wrong_drawings(name, camera):
    tip, code, sentence = WRONG[name]
    seen = frames(line(tip @ camera.T), line(np.tile(camera @ UNIT, (N, 1))))
    shown = body_shown(seen, TOP)
    if (
        name in ("mirrored", "shifted")
        and len(camera) == 2
        and np.array_equal(tip @ camera.T, TIP @ camera.T)
    ):
        assert shown.found is True, "what is wrong is not to be seen in this plane"
    else:
        assert shown.found is False and shown.code == code, shown
        assert sentence in shown.sentence or (name in FLAT and "coordinates" in shown.sentence), (
            shown.sentence
        )


@pytest.mark.parametrize(
    "name",
    [
        "double speed",
        "twice",
        "half speed",
        "first ten",
        "e1",
        "R L",
        "transposed",
        "omega",
        "shuffled",
        "late",
    ],
)
def test_wrong_drawings_by_the_students_own_camera(name):
    tip, code, _ = WRONG[name]
    shown = body_shown(scene(tip, camera=ISOMETRIC), TOP)
    assert shown.found is False and shown.code in (code, "wrong-motion"), shown


def test_a_view_that_nothing_confirms_is_not_judged():
    shown = body_shown(scene(TIP, camera=ISOMETRIC, momentum=False), TOP)
    assert shown.found is None and "draw L" in shown.sentence
    opposite = body_shown(scene(-TIP, camera=ISOMETRIC @ np.eye(3)), TOP)
    assert opposite.found is False and "opposite sides" in opposite.sentence


def test_what_stands_still_is_not_the_body_unless_a_picture_is_painted():
    still = watched(np.ones_like(TIP))
    nothing = still | {"tracks": np.zeros((N, 1, 3)), "owners": np.zeros((1, 3))}
    for seen in (still, nothing):
        assert body_shown(seen, TOP).found is False
        assert body_shown(seen, TOP).code == ("static" if seen is still else None)
        assert body_shown(seen | {"cost": np.array([96, 1, 0, 0, 1.0])}, TOP).found is None
    assert momentum_shown(nothing, TOP).found is None


def test_what_cannot_be_seen_is_static():
    nothing = watched(np.ones_like(TIP)) | {"visible": np.array([0.0, 1.0])}
    shown = body_shown(nothing, TOP)
    assert (
        shown.found is False
        and shown.code == "static"
        and "nothing that moves can be seen: " in shown.sentence
    )
    wrong = body_shown(scene(R[:, :, 0]) | {"visible": np.array([0.1, 1.0])}, TOP)
    assert wrong.found is False and "artists that cannot be seen do not count" in wrong.sentence
    assert body_shown(scene(TIP) | {"visible": np.array([0.1, 1.0])}, TOP).found is True


def test_what_changes_once_is_static():
    seldom = body_shown(scene(TIP[[0] + (N - 1) * [N - 1]]), TOP)
    assert (
        seldom.found is False and seldom.code == "static" and "at only 1 of 96 frames" in seldom.sentence
    ), seldom
    assert body_shown(scene(TIP * [1, 1, 0] + [0, 0, 0.3]), TOP).code != "static"


def test_a_few_frames_show_nothing():
    few = body_shown(watched(TIP[::12]), TOP)
    assert few.found is False and "too short" in few.sentence
    part = body_shown(watched(TIP[:12]), TOP)
    assert part.found is False and "only samples 0–11 of 96" in part.sentence


def test_forged_arrays_are_no_fault():
    good = scene(TIP)
    for forged in (
        {"owners": np.zeros((5, 3))},
        {"at": np.zeros((3, 3))},
        {"tracks": np.full((N, 4, 3), 1e200)},
    ):
        assert body_shown(good | forged, TOP).found is False
        assert momentum_shown(good | forged, TOP).found is None
    rng = np.random.default_rng(5)
    for scale in (1e-300, 1.0, 1e90):
        wild = {
            "tracks": scale * rng.normal(size=(N, 4, 3)),
            "at": np.abs(scale * rng.normal(size=(N, 3))) + 1,
        }
        assert body_shown(good | wild, TOP).found is not True
        assert momentum_shown(good | wild, TOP).found is not True


def cone(angle):
    """Unit vectors (f, 3) that turn with ê₃ about L at another ``angle``."""
    across = TIP - np.outer(TIP @ UNIT, UNIT)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    return np.cos(angle) * UNIT + np.sin(angle) * across


ALMOST = {
    "narrow": (cone(0.5), "on a cone of 29° about L"),
    "wide": (cone(1.4), "on a cone of 80° about L"),  # its tip alone is a scaled and shifted ê₃
    "about z": (
        np.column_stack([np.cos(3 * T), np.sin(3 * T), 0.5 + 0 * T]),
        "the z coordinate of the drawing is constant",
    ),
    "level": (TIP * [1, 1, 0] + [0, 0, TIP[0, 2]], "the z coordinate of the drawing is constant"),
    "noise": (TIP + 0.05 * np.random.default_rng(4).normal(size=TIP.shape), "scatters about its path"),
    "twice": (TIP[2 * ALL % 96], "runs twice as fast and begins again"),
    "omega": (L / 1.25 - 0.3 * TIP, "follows ω"),
    "omega, unit": (
        (L / 1.25 - 0.3 * TIP) / np.linalg.norm(L / 1.25 - 0.3 * TIP, axis=1)[:, None],
        "follows ω",
    ),
}


@pytest.mark.parametrize("name", ALMOST)
def test_what_resembles_the_axis_is_named(name):
    tip, sentence = ALMOST[name]
    shown = body_shown(frames(line(tip), [np.tile(tip[0], (N, 1)), tip], line(np.tile(UNIT, (N, 1)))), TOP)
    assert shown.found is False and sentence in shown.sentence, shown


def test_axes_labelled_with_two_coordinates_show_these():
    both = panels(scene(TIP, camera=XY), scene(TIP, camera=XZ), labels=[(0, 0, 1), (1, 0, 2)])
    assert body_shown(both, TOP).found and momentum_shown(both, TOP).found
    for wrong, said in (
        (XY, "axes labelled x and z show x and y"),
        (XZ[::-1], "axes labelled x and z show z and x"),
    ):
        shown = body_shown(
            panels(scene(TIP, camera=XY), scene(TIP, camera=wrong), labels=[(0, 0, 1), (1, 0, 2)]), TOP
        )
        assert (shown.found, shown.code) == (False, "mirrored") and said in shown.sentence
    assert body_shown(panels(scene(TIP, camera=XY), scene(TIP, camera=XZ[::-1])), TOP).found, "without labels"
    assert body_shown(panels(scene(TIP, camera=XZ), labels=[(0, -1, 2)]), TOP).found, "one label alone"


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
        assert body_shown(panels(scene(TIP), beside), TOP).found
    for tip in (TIP[2 * ALL % 96], TIP[ALL // 2], TIP[ALL // 10]):
        shown = body_shown(panels(scene(TIP), scene(tip, camera=XZ)), TOP)
        assert (shown.found, shown.code) == (False, "wrong-frames"), shown
        assert shown.sentence.startswith("one of the axes is wrong: ê₃ is drawn, but")


@pytest.mark.parametrize("unit", [1.0, 180 / np.pi], ids=["radians", "degrees"])
def test_polar_axes_may_be_a_map_of_directions(unit):
    def placed(v):
        return unit * np.arccos(v[..., 2:]) * v[..., :2] / np.linalg.norm(v[..., :2], axis=-1, keepdims=True)

    def drawn(tip):
        seen = frames([placed(tip)], [np.tile(placed(UNIT), (len(tip), 1))])
        return seen | {"labels": np.array([[0.0, -2.0, -2.0]])}

    assert body_shown(drawn(TIP), TOP).found and momentum_shown(drawn(TIP), TOP).found
    assert body_shown(drawn(R[:, :, 0]), TOP).found is False
    assert body_shown(drawn(TIP[2 * ALL % 96]), TOP).found is False


def test_with_one_frame_for_each_sample_no_part_is_stretched():
    stretched = np.interp(0.7 * ALL, ALL, ALL)
    tip = np.column_stack([np.interp(stretched, ALL, column) for column in TIP.T])
    shown = body_shown(scene(tip), TOP)
    assert shown.code == "wrong-frames" and "frame 95 of 96 shows sample 66 of 96" in shown.sentence, shown
    assert body_shown(scene(tip[::2]), TOP).found, "a part with a full turn at another number of frames"


def test_what_is_drawn_in_place_of_L_or_stands_still_is_named():
    omega = L / 1.25 - 0.3 * TIP
    shown = momentum_shown(frames(line(TIP), line(omega)), TOP)
    assert (shown.found, shown.code) == (False, "moving-angular-momentum") and "follows ω" in shown.sentence
    shown = body_shown(scene(TIP[np.minimum(ALL, 12)]), TOP)
    assert (
        shown.code == "wrong-frames" and "from frame 12 of 96 on the picture stands still" in shown.sentence
    ), shown


def test_an_axis_in_perspective():
    def seen(v):
        return (v @ ISOMETRIC.T) / (1 - v @ np.cross(*ISOMETRIC) / 6)[:, None]

    def drawn(tip, L=UNIT):
        return frames(line(seen(tip)), line(np.tile(seen(L[None]), (len(tip), 1))))

    assert body_shown(drawn(TIP), TOP).found and momentum_shown(drawn(TIP), TOP).found
    for wrong in (drawn(R[:, :, 0]), drawn(TIP, np.eye(3)[2]), drawn(TIP * [1, -1, 1])):
        assert not body_shown(wrong, TOP).found or not momentum_shown(wrong, TOP).found


@pytest.mark.parametrize("axis", [0, 1])
def test_another_axis_of_another_body(axis):
    """The data alone says what is drawn: the first or second axis of an unsymmetric body, with its own L."""
    body = Body(T, TUMBLE, axis=axis, L=TUMBLE[0] @ [0.3, 0.9, -0.4])
    unit = body.L / np.linalg.norm(body.L)
    for camera in (SPACE, VIEW, XY, ISOMETRIC):
        seen = scene(TUMBLE[:, :, axis], L=unit, camera=camera)
        assert body_shown(seen, body).found is True and momentum_shown(seen, body).found is True
    wrong = body_shown(scene(TUMBLE[:, :, 2], L=unit), body)
    assert wrong.code == "wrong-axis" and f"follows ê₃, not ê{'₁₂'[axis]}" in wrong.sentence
    transposed = body_shown(scene(TUMBLE[:, axis, :], L=unit), body)
    column = f"is R[:, :, {axis}], its {('first', 'second')[axis]} column"
    assert transposed.code == "transposed-rotation" and column in transposed.sentence
