"""The Setup cell has the course notebook's names, signatures and behaviour; the chart's numbers, and the
motion to draw.
"""

import inspect
import sys

import numpy as np
import pytest

import reference
from exercises.authoring.assignments.catalogue import find
from exercises.authoring.assignments.speed_vs_accuracy import SETTINGS as EVERY
from exercises.authoring.kinds.dynamics import MOST_SWEPT
from exercises.rigid_body.assignment import TILT
from service.grading.sandbox_job import truth

SOURCE = find("rigid-body").setup
I, W0 = (2.0, 3.0, 4.0), (1.0, 0.6, 0.8)


@pytest.fixture
def names(monkeypatch):
    monkeypatch.setattr(sys, "path", [*sys.path, str(find("rigid-body").folder / "course")])
    scope = {}
    exec(compile(SOURCE, "Setup", "exec"), scope)
    scope["euler_eqs"] = lambda t, w, I: reference.euler_rhs(np.asarray(w), I)
    return scope


def test_signatures_are_the_courses(names):
    assert [str(inspect.signature(names[f])) for f in ("T_rot", "L_body", "integrate_body", "box_polys")] == [
        "(w, I)",
        "(w, I)",
        "(w0, I, t_eval, R0=None)",
        str(inspect.signature(names["box_polys"])),
    ]
    assert list(inspect.signature(names["box_polys"]).parameters) == ["R", "half"]
    assert len(names["FACE_COLORS"]) == 6 and isinstance(names["FACE_COLORS"], list)


def test_the_meters_take_one_spin_and_a_series(names):
    assert f"{names['T_rot'](W0, I):.6f}" == "2.820000"
    assert f"{np.linalg.norm(names['L_body'](W0, I)):.6f}" == "4.180909"
    series = np.tile(np.array(W0)[:, None], 5)
    assert names["T_rot"](series, I).shape == (5,) and names["L_body"](series, I).shape == (3, 5)


def test_integrate_body_runs_from_the_first_time_to_the_last_in_any_attitude(names):
    t = np.linspace(3.0, 5.0, 21)
    turn = reference.motion(W0, I, [0.0, 1.0], need="orientation").R[1]
    w, R = names["integrate_body"](W0, I, t, R0=turn)
    exact = reference.motion(W0, I, t - 3.0, need="orientation")
    assert w.shape == (3, 21) and R.shape == (21, 3, 3)
    np.testing.assert_allclose(w, exact.w, atol=1e-9)
    np.testing.assert_allclose(R, turn @ exact.R, atol=1e-9)


def test_integrate_body_calls_euler_eqs_as_it_is_defined_now(names):
    t = np.linspace(0.0, 1.0, 5)
    names["euler_eqs"] = lambda t, w, I: np.ones(3)
    w, _ = names["integrate_body"](W0, I, t)
    np.testing.assert_allclose(w, np.add.outer(W0, t), atol=1e-12)
    del names["euler_eqs"]
    with pytest.raises(NameError, match="euler_eqs"):
        names["integrate_body"](W0, I, t)


def test_integrate_body_takes_the_older_order_of_arguments(names):
    t = np.linspace(0.0, 2.0, 9)
    new, old = names["integrate_body"](W0, I, t), names["integrate_body"](names["euler_eqs"], W0, I, t)
    assert all(np.array_equal(a, b) for a, b in zip(new, old, strict=True))


SETTINGS = len(EVERY)
SWEEP = find("rigid-body").sweep


def seen(**changed):
    truth = SWEEP.scene.truth(SWEEP.scene.inputs)
    return {
        "w": np.stack([truth["w"]] * SETTINGS),
        "calls": np.full(SETTINGS, 500.0),
        "seconds": np.full(SETTINGS, 0.01),
        "per_call": np.array(1e-6),
    } | changed, truth


def test_numbers_in_their_ranges_and_a_run_of_the_most_calls_was_stopped():
    assert not any(p.stopped for p in SWEEP.read(*seen()).points)
    result = SWEEP.read(*seen(calls=np.full(SETTINGS, 20_001.0)))
    assert all(p.stopped and p.calls == MOST_SWEPT + 1 for p in result.points)


@pytest.mark.parametrize("calls", [0.0, -1.0, 20_002.0, 1.5, 1e300, np.inf, np.nan])
def test_calls_that_no_run_makes(calls):
    with pytest.raises(ValueError, match="a number of calls is not a whole number from 1 to 20001"):
        SWEEP.read(*seen(calls=np.array([calls, *[500.0] * (SETTINGS - 1)])))


@pytest.mark.parametrize("name", ["seconds", "per_call"])
@pytest.mark.parametrize("time", [-1e-9, 81.0, np.inf, np.nan])
def test_times_that_no_run_takes(name, time):
    with pytest.raises(ValueError, match="a time is not between 0 and 80 s"):
        SWEEP.read(*seen(**{name: np.full((SETTINGS,) if name == "seconds" else (), time)}))


def test_the_film_starts_away_from_every_axis_and_plane(rigid_body):
    scene = rigid_body.scene("film")
    given = truth(scene, scene.inputs)
    axis, unit = given["R"][:, :, 2], given["L"] / np.linalg.norm(given["L"])
    assert np.abs(unit).min() > 0.1 and np.abs(axis[0]).min() > 0.1
    assert axis.min(axis=0).max() < -0.1 and axis.max(axis=0).min() > 0.1, "it crosses each coordinate plane"
    exact = reference.motion((2.2, 0.0, 0.5), (1.25, 1.25, 2.0), given["t"], need="orientation").R
    assert np.allclose(given["R"], TILT @ exact)
