"""The closed form against sixty-digit truth by other formulas, against closed forms in degenerate regimes,
and at its seams.
"""

from pathlib import Path

import numpy as np
import pytest

from reference import (
    Exact,
    box_moments,
    kinetic_energy,
    momentum_norm,
    motion,
    orthonormality_error,
    space_momentum,
)
from tests.reference.make_truth import truth

TRUTH = np.load(Path(__file__).parent / "truth.npz")
FAMILIES = ("generic", "separatrix", "tennis", "near-symmetric", "rod", "near-steady")
BOOK = box_moments(1, 2, 1.4, 0.4)
OCTANTS = np.array(np.meshgrid([1, -1], [1, -1], [1, -1])).reshape(3, -1).T


def errors(rows):
    """Largest |Δω| / |ω₀| and |ΔR| over those rows of the truth."""
    omega = attitude = 0.0
    for i in rows:
        sampled = Exact(TRUTH["w0"][i], TRUTH["I"][i]).sample(TRUTH["t"][i], orientation=True)
        omega = max(omega, np.abs(sampled.w.T - TRUTH["w"][i]).max() / np.linalg.norm(TRUTH["w0"][i]))
        attitude = max(attitude, np.abs(sampled.R - TRUTH["R"][i]).max())
    return omega, attitude


@pytest.mark.parametrize("family", range(6), ids=FAMILIES)
def test_against_sixty_digits_to_a_hundred_million_periods(family):
    rows = np.flatnonzero(TRUTH["family"] == family)
    assert len(rows) >= 350
    chosen = np.random.default_rng().choice(rows, 60, replace=False)
    omega, attitude = errors(chosen)
    assert omega <= 2e-15 and attitude <= 3e-15, chosen.tolist()


@pytest.mark.parametrize(("size", "speed"), [(1e100, 1.0), (1e-100, 1.0), (1e150, 1e100), (1e-100, 1e-80)])
@pytest.mark.parametrize("w0", [(1.0, 0.6, 0.8), (0.2, 0.3, 1.1)], ids=["dual", "direct"])
def test_a_body_of_any_size_and_speed_against_sixty_digits(w0, size, speed):
    I, spin = np.array([2.0, 3.0, 4.0]) * size, np.array(w0) * speed
    t, w, R = truth(I, spin, np.array([0.3, -1.7, 12.9]))
    sampled = Exact(spin, I).sample(t, orientation=True)
    assert np.abs(sampled.w.T - w).max() <= 2e-15 * np.linalg.norm(spin)
    assert np.abs(sampled.R - R).max() <= 3e-15


@pytest.mark.parametrize("family", range(6), ids=FAMILIES)
def test_invariants(family):
    rng = np.random.default_rng(family)
    for i in rng.choice(np.flatnonzero(TRUTH["family"] == family), 15, replace=False):
        w0, I = TRUTH["w0"][i], TRUTH["I"][i]
        exact = Exact(w0, I)
        run = exact.sample(rng.uniform(-20, 20, 200) * exact.period, orientation=True)
        assert np.abs(kinetic_energy(run.w, I) / kinetic_energy(w0, I) - 1).max() <= 5e-15
        assert np.abs(momentum_norm(run.w, I) / momentum_norm(w0, I) - 1).max() <= 5e-15
        assert orthonormality_error(run.R).max() <= 1.5e-15
        L = space_momentum(run.R, run.w, I)
        assert np.abs(L - I * w0).max() <= 5e-15 * np.linalg.norm(I * w0)


@pytest.mark.parametrize("signs", OCTANTS.tolist())
@pytest.mark.parametrize("order", [(0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)])
def test_every_order_of_the_moments_and_every_octant(order, signs):
    """Renaming axes changes names only; reflecting two of them is a turn of the body; reflecting all reverses
    time.
    """
    order, signs = list(order), np.array(signs, dtype=float)
    I, w0, t = np.array([2.0, 3.0, 4.0]), np.array([1.0, 0.6, 0.8]), np.linspace(-9, 20, 50)
    handed = np.prod(signs) * np.linalg.det(np.eye(3)[order])
    base = motion(w0, I, handed * t, need="orientation")
    turned = motion((signs * w0)[order], I[order], t, need="orientation")
    np.testing.assert_allclose(turned.w, (signs[:, None] * base.w)[order], rtol=0, atol=4e-15)
    S = np.diag(signs)[order]
    np.testing.assert_allclose(turned.R, S @ base.R @ S.T, rtol=0, atol=5e-15)


@pytest.mark.parametrize("signs", OCTANTS.tolist())
def test_exactly_on_the_separatrix(signs):
    """I₁ω₁²(I₂ − I₁) = I₃ω₃²(I₃ − I₂) in doubles; ω₂ = (2T/I₂)^½ tanh(…), and the body ends in a spin about
    ê₂.
    """
    I, w0 = np.array([3.0, 4.0, 6.0]), np.array([2.0, 1.0, 1.0]) * signs
    exact = Exact(w0, I)
    assert exact.model == "separatrix" and exact.period == np.inf
    t = np.linspace(-3, 3, 301)
    run = exact.sample(t, orientation=True)
    speed = np.sqrt(2 * kinetic_energy(w0, I) / I[1])
    rate = speed * np.sqrt((I[1] - I[0]) * (I[2] - I[1]) / (I[0] * I[2]))
    sense = np.sign(w0[0] * w0[2])
    expected = speed * np.tanh(sense * rate * t + np.arctanh(w0[1] / speed))
    np.testing.assert_allclose(run.w[1], expected, rtol=0, atol=2e-15)
    assert np.ptp(space_momentum(run.R, run.w, I), axis=0).max() < 1e-14
    step = 1e-5
    rate_of_R = (exact.attitude(t + step) - exact.attitude(t - step)) / (2 * step)
    skew = np.array([[[0, -z, y], [z, 0, -x], [-y, x, 0]] for x, y, z in run.w.T])
    np.testing.assert_allclose(rate_of_R, run.R @ skew, rtol=0, atol=1e-8)


def test_models_and_their_closed_forms():
    t = np.linspace(-5, 50, 200)
    sphere = Exact((1, 2, 2), (2, 2, 2))
    assert sphere.model == "steady" and sphere.period == 0
    assert (sphere.omega(t) == np.array([[1], [2], [2]])).all()
    axis = np.array([1, 2, 2]) / 3
    np.testing.assert_allclose(sphere.attitude(t) @ axis, np.tile(axis, (200, 1)), atol=1e-15)
    np.testing.assert_allclose(
        np.trace(sphere.attitude(t), axis1=1, axis2=2), 1 + 2 * np.cos(3 * t), atol=5e-15
    )
    assert (
        Exact((0, -2, 0), (2, 3, 4)).model == "steady"
        and Exact((0, 0, 0), (2, 3, 4)).attitude([7.0])[0].tolist() == np.eye(3).tolist()
    )
    top = Exact((0.4, 0.0, 3.0), (1, 1, 1.6))
    assert top.model == "symmetric"
    np.testing.assert_allclose(
        top.omega(t), [0.4 * np.cos(1.8 * t), 0.4 * np.sin(1.8 * t), 3 + 0 * t], atol=1e-14
    )
    assert (
        Exact((0.2, 0.3, 1.1), (2, 3, 4)).model == "direct" and Exact((0.12, 6, 0.12), BOOK).model == "dual"
    )


@pytest.mark.parametrize("gap", [1e-15, 1e-14, 1e-12, 1e-8])
def test_crossing_from_symmetric_to_direct_changes_no_digit(gap):
    """Near symmetry the two models differ by what the gap itself makes, and by rounding."""
    t = np.linspace(0, 3, 100)
    at, beside = (
        motion((0.4, 0.1, 3), (1, 1, 1.6), t, need="orientation"),
        motion((0.4, 0.1, 3), (1, 1 + gap, 1.6), t, need="orientation"),
    )
    assert (at.model, beside.model) == ("symmetric", "direct")
    allowed = 2e-15 + 40 * gap
    assert np.abs(at.w - beside.w).max() <= allowed and np.abs(at.R - beside.R).max() <= allowed


def test_crossing_from_direct_to_dual_changes_no_digit():
    """Both series at k² = ½, where either may serve."""
    from reference import theta
    from reference.polhode import polhode
    from reference.precise import turns

    rng = np.random.default_rng(4)
    for _ in range(20):
        edges = np.sort(rng.uniform(0.3, 2, 3))[::-1]
        I = box_moments(1, *edges)
        w1, w2 = rng.uniform(0.2, 1, 2)
        # k² = ½ means D₁(I₃−I₂) = 2 D₃(I₂−I₁); solve for ω₃².
        q1, q2 = I[0] * w1**2, I[1] * w2**2
        left, right = I[2] - I[1], I[1] - I[0]
        span = I[2] - I[0]
        q3 = (2 * right * (q1 * span + q2 * left) - left * q2 * right) / (left * span)
        p = polhode((w1, w2, float(np.sqrt(q3 / I[2]))), tuple(I))
        assert abs(p.k2 - 0.5) < 1e-12
        t = rng.uniform(-5, 5, 100) * p.period
        other, (whole, rest) = _other_side(p), turns([p.phase], [p.start], t)
        for one, two in zip(
            theta.Direct(p)(whole[0], rest[0])[:3], theta.Dual(other)(whole[0], rest[0])[:3], strict=True
        ):
            assert np.abs(one - two).max() <= 2e-15 * p.momentum


def _other_side(p):
    """The same polhode with its constants stated for the dual series; at k² = ½ the nomes are equal."""
    import dataclasses

    return dataclasses.replace(p, offset=p.offset / 2)


def test_initial_attitude_and_negative_time():
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    there = motion((1, 0.6, 0.8), (2, 3, 4), [4.0], need="orientation", R0=quarter)
    plain = motion((1, 0.6, 0.8), (2, 3, 4), [4.0], need="orientation")
    assert np.abs(there.R - quarter @ plain.R).max() < 1e-15
    back = motion(there.w[:, 0], (2, 3, 4), [-4.0], need="orientation", R0=there.R[0])
    assert np.abs(back.w[:, 0] - [1, 0.6, 0.8]).max() < 4e-15 and np.abs(back.R[0] - quarter).max() < 5e-15


def test_omega_alone_is_the_same_to_the_bit_and_cut_into_chunks_too():
    t = np.linspace(0, 300, 5000)
    for w0, I in (((1, 0.6, 0.8), (2, 3, 4)), ((0.2, 0.3, 1.1), (2, 3, 4)), ((0.12, 6, 0.12), BOOK)):
        exact = Exact(w0, I)
        assert np.abs(exact.omega(t) - exact.sample(t, orientation=True).w).max() == 0
        assert np.abs(exact.omega(t[3000:]) - exact.omega(t)[:, 3000:]).max() < 1e-15 * 6
        assert (exact.momentum(t[:3]) == np.asarray(I)[:, None] * exact.omega(t[:3])).all()
