import numpy as np
import pytest
from scipy.integrate import solve_ivp

from reference import (
    attitude_rate,
    euler_rhs,
    kinetic_energy,
    momentum_norm,
    motion,
    orthonormality_error,
    space_momentum,
)

I, W0 = (2.0, 3.0, 4.0), (1.0, 0.6, 0.8)


def test_symmetric_top_against_its_closed_form():
    """ω₁ + iω₂ turns at (I₃ − I₁)/I₁ ω₃ (Landau & Lifshitz §36)."""
    t = np.linspace(0, 8, 200)
    w = motion((0.4, 0.0, 3.0), (1, 1, 1.6), t).w
    np.testing.assert_allclose(
        w, [0.4 * np.cos(1.8 * t), 0.4 * np.sin(1.8 * t), np.full_like(t, 3.0)], rtol=0, atol=1e-9
    )


def test_invariants_and_attitude():
    run = motion(W0, I, np.linspace(0, 20, 400), need="orientation")
    assert run.R is not None and run.R.shape == (400, 3, 3)
    assert np.ptp(kinetic_energy(run.w, I)) < 1e-14
    assert np.ptp(momentum_norm(run.w, I)) < 1e-14
    assert orthonormality_error(run.R).max() < 1.5e-15
    assert np.ptp(space_momentum(run.R, run.w, I), axis=0).max() < 2e-14


def test_omega_alone_never_touches_the_attitude(monkeypatch):
    def forbidden(*args):
        raise AssertionError("the attitude was worked out")

    monkeypatch.setattr("reference.exact._quaternion", forbidden)
    run = motion(W0, I, [0.0, 1.0], need="omega")
    assert run.R is None and run.model == "dual" and "k²" in run.why
    with pytest.raises(AssertionError):
        motion(W0, I, [0.0, 1.0], need="orientation")


def test_the_notebooks_integrator_agrees_to_its_own_error():
    t = np.linspace(0, 20, 400)
    run = motion(W0, I, t, need="orientation")

    def rhs(_, y):
        return np.concatenate([euler_rhs(y[:3], I), attitude_rate(y[3:].reshape(3, 3), y[:3]).ravel()])

    y = solve_ivp(
        rhs, (0, 20), [*W0, *np.eye(3).ravel()], method="DOP853", t_eval=t, rtol=1e-11, atol=1e-13
    ).y
    assert np.abs(run.w - y[:3]).max() < 5e-13
    assert np.abs(run.R - y[3:].T.reshape(-1, 3, 3)).max() < 5e-11


def test_both_needs_agree_on_omega():
    t = np.linspace(0, 20, 100)
    np.testing.assert_allclose(motion(W0, I, t).w, motion(W0, I, t, need="orientation").w, rtol=0, atol=0)


def test_only_the_start():
    run = motion(W0, I, [0.0], need="orientation")
    assert np.abs(run.w[:, 0] - W0).max() < 5e-16 and np.abs(run.R[0] - np.eye(3)).max() < 5e-16


@pytest.mark.parametrize(
    ("w0", "t", "why"),
    [
        ((1, 2), [0, 1], "w0"),
        ((1, 2, np.inf), [0, 1], "w0"),
        (W0, [], "t is"),
        (W0, [[0.0]], "t is"),
        (W0, [np.nan], "t is"),
    ],
)
def test_unphysical_input(w0, t, why):
    with pytest.raises(ValueError, match=why):
        motion(w0, I, t)


def test_unknown_need():
    with pytest.raises(ValueError, match="need"):
        motion(W0, I, [0.0], need="everything")  # type: ignore[arg-type]
