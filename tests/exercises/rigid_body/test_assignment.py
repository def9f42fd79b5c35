"""The Setup cell has the course notebook's names, signatures and behaviour."""

import inspect
import sys

import numpy as np
import pytest

import reference
from exercises.authoring.assignments.catalogue import find

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
