"""Animations of points that follow given trajectories: drawn in any style, and wrong ones named."""

import json
from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.animation import ArtistAnimation, FuncAnimation

from exercises.authoring.kinds.animation import animation
from polhode.judging.outcome import Tolerance
from polhode.judging.verdict import Verdict
from polhode.kinds import question_checks
from polhode.kinds.animation.trajectories import followed
from service.grading.grade import grade
from service.grading.submission import Submission
from tests.support.solutions import solution
from tests.support.toolbox import check_locally, mistaken

PIVOTS = np.array([[-0.7, 0.0], [0.7, 0.0]])


def axes(**shown):
    fig, ax = plt.subplots(figsize=(3, 2), **shown)
    plt.close(fig)
    return fig, ax


def limited(ax, scale=1):
    ax.set(xlim=(-1.8 * scale, 1.8 * scale), ylim=(-1.2 * scale, 0.2 * scale))


def scatter(t, a, b):
    fig, ax = axes()
    limited(ax)
    bobs = ax.scatter(*np.array([a[0], b[0]]).T)
    return FuncAnimation(fig, lambda k: bobs.set_offsets([a[k], b[k]]), frames=len(t))


def lines_from_the_pivots(t, a, b):
    fig, ax = axes()
    limited(ax)
    rods = [ax.plot([], [], "o-")[0] for _ in PIVOTS]

    def update(k):
        for rod, pivot, bob in zip(rods, PIVOTS, (a[k], b[k]), strict=True):
            rod.set_data([pivot[0], bob[0]], [pivot[1], bob[1]])
        return rods

    return FuncAnimation(fig, update, frames=range(len(t)), blit=True)


def circles(t, a, b):
    """Of two sizes, so that their rims are at different places beside the centres."""
    fig, ax = axes()
    limited(ax)
    bobs = [ax.add_patch(plt.Circle(x[0], radius)) for x, radius in ((a, 0.05), (b, 0.15))]

    def update(k):
        for bob, x in zip(bobs, (a, b), strict=True):
            bob.center = x[k]
        return bobs

    return FuncAnimation(fig, update, frames=len(t), blit=True)


def artist_animation(t, a, b):
    fig, ax = axes()
    limited(ax)
    return ArtistAnimation(
        fig, [ax.plot([p[0], q[0]], [p[1], q[1]], "ko") for p, q in zip(a, b, strict=True)]
    )


def cleared_every_frame(t, a, b):
    fig, ax = axes()

    def update(k):
        ax.cla()
        limited(ax)
        ax.plot(*a[k], "ro")
        ax.plot(*b[k], "bo")

    return FuncAnimation(fig, update, frames=len(t))


def in_centimetres_with_a_trail(t, a, b):
    fig, ax = axes()
    limited(ax, 100)
    trails = [ax.plot([], [], "-", markevery=[-1], marker="o")[0] for _ in (a, b)]

    def update(k):
        for trail, x in zip(trails, (a, b), strict=True):
            trail.set_data(*100 * x[: k + 1].T)
        return trails

    return FuncAnimation(fig, update, frames=len(t))


def two_panels_every_second_sample(t, a, b):
    fig, panels = axes(nrows=1, ncols=2)
    points = []
    for ax, x in zip(panels, (a, b), strict=True):
        limited(ax)
        points.append(ax.plot(*x[0], "s")[0])

    def update(k):
        for point, x in zip(points, (a, b), strict=True):
            point.set_data(x[k, :1], x[k, 1:])

    return FuncAnimation(fig, update, frames=range(0, len(t), 2))


def in_space(t, a, b):
    fig, ax = axes(subplot_kw={"projection": "3d"})
    ax.set(xlim=(-2, 2), ylim=(-1, 1), zlim=(-1.5, 0.5))
    ax.view_init(10, 40)
    (bobs,) = ax.plot([], [], [], "o")
    return FuncAnimation(
        fig, lambda k: bobs.set_data_3d([a[k, 0], b[k, 0]], [0, 0], [a[k, 1], b[k, 1]]), frames=len(t)
    )


SOME, MORE = (
    (scatter, circles),
    (
        lines_from_the_pivots,
        artist_animation,
        cleared_every_frame,
        in_centimetres_with_a_trail,
        two_panels_every_second_sample,
        in_space,
    ),
)


def question(toolbox):
    return next(q for q in toolbox.notebook.questions() if q.kind == "animation")


def outcomes(asked, seen, truth):
    """Return the outcomes of the public checks by the end of their ids."""
    return {
        c.id.split("-")[-1]: c.judge([seen], [truth])
        for c in question_checks(asked, f"{asked['id']}-public", False)
    }


@pytest.mark.parametrize("drawing", [*SOME, *(pytest.param(one, marks=pytest.mark.slow) for one in MORE)])
def test_any_drawing_of_the_points_passes(toolbox, drawing):
    asked = question(toolbox)
    found = outcomes(asked.document, asked.play(drawing, {}), asked.exact({}))
    assert set(found) == {"moves", "a", "b"}
    for outcome in found.values():
        assert outcome.verdict is Verdict.PASS, outcome.line


def recorded(*paths, labels=(-1, -1)):
    """What the recorder returns of markers on ``paths`` (f, d), in one axes."""
    frames, d = paths[0].shape
    still = np.zeros((1, 4, 4, 3), np.uint8)
    return {
        "frames": np.concatenate([still, still + 255]),
        "tracks": np.pad(np.stack(paths, axis=1), ((0, 0), (0, 0), (0, 3 - d))),
        "owners": np.array([[k, d, 0] for k, _ in enumerate(paths, 1)], float),
        "labels": np.array([[0, *labels]], float),
        "at": np.column_stack([np.arange(frames), np.arange(frames), np.full(frames, frames)]).astype(float),
        "cost": np.array([frames, 1.0, 0, 0, 0, 0]),
        "visible": np.array([1.0, 0.0]),
    }


ALL = np.arange(50)


@pytest.mark.parametrize(
    ("change", "failed", "sentence"),
    [
        (lambda a, b: (a, 0 * b + b[0]), "b", "nothing that moves follows b"),
        (lambda a, b: (a, a + [1.4, 0]), "b", "b is drawn, but its samples are mistimed"),
        (lambda a, b: (a, b + [0.3, 0]), "b", "b is drawn at another scale or place than the others"),
        (lambda a, b: (a, 0.5 * b), "b", "b is drawn at another scale or place than the others"),
        (lambda a, b: (a * [-1, 1], b * [-1, 1]), "ab", "is drawn with the sign of x reversed"),
        (lambda a, b: (-a, -b), "ab", "nothing that moves follows"),
        (lambda a, b: (a[:, ::-1], b[:, ::-1]), "ab", "is drawn with x and y exchanged"),
        (lambda a, b: (a[::-1], b[::-1]), "ab", "is drawn backwards in time"),
        (lambda a, b: (a[ALL // 2], b[ALL // 2]), "ab", "shows only samples 0–24 of 50"),
        (lambda a, b: (a[2 * ALL % 50], b[2 * ALL % 50]), "ab", "begins again"),
        (lambda a, b: (a[ALL**2 // 50], b[ALL**2 // 50]), "ab", "its samples are mistimed"),
        (
            lambda a, b: (a[np.minimum(2 * ALL, 49)], b[np.minimum(2 * ALL, 49)]),
            "ab",
            "later frames do not change",
        ),
        (lambda a, b: (np.outer(ALL, [0.01, 0]), b[:1] + 0 * a), "ab", "nothing that moves follows"),
        (lambda a, b: (a[:6], b[:6]), "ab", "too short to show the motion: 6 frames"),
    ],
    ids=[
        *("static", "copy", "shifted", "shrunk", "mirrored", "turned", "exchanged"),
        *("backwards", "half speed", "double speed", "uneven", "held", "other path", "short"),
    ],
)
def test_a_wrong_drawing_fails_with_its_reason(toolbox, change, failed, sentence):
    truth = question(toolbox).exact({})
    found = outcomes(question(toolbox).document, recorded(*change(truth["a"], truth["b"])), truth)
    assert {name for name, outcome in found.items() if outcome.verdict is Verdict.FAIL} == set(failed)
    for name in failed:
        assert sentence in found[name].line, found[name].line


def interpolated(x, at):
    return np.column_stack([np.interp(at, ALL, column) for column in x.T])


@pytest.mark.parametrize("frames", [20, 37, 50, 51, 100, 240])
@pytest.mark.parametrize(
    "values", [lambda at: np.floor(at).astype(int), lambda at: np.rint(at).astype(int), lambda at: at]
)
def test_every_frame_rate_passes(toolbox, frames, values):
    truth = question(toolbox).exact({})
    at = values(np.linspace(0, 49, frames))
    found = outcomes(
        question(toolbox).document,
        recorded(interpolated(truth["a"], at), interpolated(truth["b"], at)),
        truth,
    )
    assert [outcome.verdict for outcome in found.values()] == [Verdict.PASS] * 3, [
        outcome.line for outcome in found.values()
    ]


@pytest.mark.parametrize(("before", "after"), [(12, 0), (0, 30), (20, 25)])
def test_the_first_and_the_last_picture_may_be_repeated(toolbox, before, after):
    truth, order = question(toolbox).exact({}), np.repeat(ALL[::2], [1 + before, *[1] * 23, 1 + after])
    seen = recorded(truth["a"][order], truth["b"][order])
    seen["at"][:, 1] = order
    found = outcomes(question(toolbox).document, seen, truth)
    assert [o.verdict for o in found.values()] == [Verdict.PASS] * 3, [o.line for o in found.values()]
    astray = {**seen, "tracks": seen["tracks"].copy()}
    astray["tracks"][before + 12] = astray["tracks"][before + 2]
    found = outcomes(question(toolbox).document, astray, truth)
    assert found["a"].verdict is Verdict.FAIL


ORBIT = np.column_stack([np.cos(ALL / 8) - 0.3, 0.9 * np.sin(ALL / 8), 0.4 * np.sin(ALL / 5)])
VIEW = np.array([[-1, 1, 0], [-1, -1, 2]]) / np.array([[np.sqrt(2)], [np.sqrt(6)]])
PLANAR = ORBIT * [1, 1, 0]


@pytest.mark.parametrize(
    ("orbit", "drawn", "labels", "found"),
    [
        (ORBIT, ORBIT, (-1, -1), True),
        (ORBIT, 2 * ORBIT + [1, 2, 3], (-1, -1), True),
        (ORBIT, ORBIT[:, [0, 2]], (-1, -1), True),
        (ORBIT, ORBIT[:, [0, 2]], (0, 2), True),
        (ORBIT, ORBIT[:, [0, 2]], (0, 1), False),
        (ORBIT, ORBIT @ VIEW.T, (-1, -1), True),
        (PLANAR, PLANAR @ VIEW.T, (-1, -1), True),
        (ORBIT, ORBIT * [1, -1, 1], (-1, -1), False),
        (ORBIT, ORBIT[:, [0, 2]] * [1, 2], (-1, -1), False),
    ],
)
def test_an_orbit_in_space(orbit, drawn, labels, found):
    shown = followed(recorded(drawn, labels=labels), ALL / 8, {"x": orbit}, 0.03)["x"]
    assert shown.found is found, shown


def test_painted_pixels_are_not_judged():
    seen = recorded(0 * ORBIT) | {"cost": np.array([50.0, 1, 0, 0, 1, 0])}
    assert followed(seen, ALL / 8, {"x": ORBIT}, 0.03)["x"].found is None


def planet(t, x):
    """Stand for a right solution."""


def test_a_drawn_trajectory_has_a_hidden_scene():
    ask = {"t": ALL / 8, "x": lambda rng: rng.uniform(1, 2) * ORBIT}
    asked = replace(
        animation(solution(planet), ask, ("x",), Tolerance(limit=0.03, reason="of a test")), id="1"
    )
    public, hidden = asked.scenes()
    inputs = [dict(public.inputs), hidden.inputs(np.random.default_rng(5))]
    scales = [float(np.ptp(asked.exact(rows)["x"]) / np.ptp(ORBIT)) for rows in inputs]
    assert 1 < min(scales) < max(scales) < 2 and set(hidden.returns) == {
        "frames",
        "tracks",
        "owners",
        "labels",
        "at",
        "visible",
        "cost",
    }
    seen = recorded(asked.exact(inputs[1])["x"]) | {"at_x": inputs[1]["x"]}
    for check in question_checks(asked.document, hidden.name, True):
        assert check.judge([seen], [hidden.truth(inputs[1])]).verdict is Verdict.PASS


def test_an_author_gets_the_errors_of_a_declaration():
    def draw(t, x, y, z):
        pass

    given = {"t": ALL / 8, "x": ORBIT[:, :2], "y": 0 * ORBIT, "z": ORBIT[:40]}
    near = Tolerance(limit=0.1, reason="of a test")
    wrong = animation(
        solution(draw), given, ("x", "y", "z"), Tolerance(rtol=0.1, atol=0.0, reason="of a test")
    )
    must = "it must be relative(…, because=…), or at_most for a count"
    assert wrong.wrong == {"agree": [f"agree is a tolerance of rtol=0.1, atol=0.0; {must}"]}
    wrong = animation(solution(draw), given, ("x", "y", "z"), near)
    assert [error.split(": ", 1)[1] for error in wrong.errors()] == [
        "the trajectories must all have 2 or all have 3 coordinates",
        "the trajectory y does not move",
        "the trajectory z has shape (40, 3); it must be (50, 2) or (50, 3)",
    ]
    absent = animation(solution(draw), {"t": ALL}, ("orbit",), near)
    assert list(absent.errors()) == ["draw has no input orbit"]


@pytest.mark.slow
@pytest.mark.parametrize(("number", "failed"), [(0, {"13-b"}), (1, {"13-a", "13-b"}), (2, {"13-b"})])
def test_a_mistake_fails_its_checks(toolbox, sandbox, number, failed):
    report = grade(
        Submission(mistaken(toolbox, "animate_pendulums", number)), toolbox.assignment, sandbox, 1
    ).report
    assert {outcome.id for outcome in report.outcomes() if outcome.verdict is Verdict.FAIL} == failed, (
        report.text()
    )


@pytest.mark.slow
def test_the_right_solution_in_the_sandbox_and_in_the_kit(toolbox, sandbox, tmp_path):
    source = question(toolbox).source
    report = grade(Submission(source), toolbox.assignment, sandbox, 1).report
    assert report.passed and [sheet.name for sheet in report.animations] == ["13-public"], report.text()
    assert json.loads(check_locally("toolbox", source, tmp_path)) == [
        outcome.line for outcome in report.outcomes()
    ]
