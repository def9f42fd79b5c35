import numpy as np
import pytest

from reference import (
    angular_momentum,
    kinetic_energy,
    momentum_norm,
    orthonormality_error,
    precession_rate,
    space_momentum,
    transverse_growth,
)

W, I = (1.0, 0.6, 0.8), (2.0, 3.0, 4.0)


def test_numbers_the_notebook_prints():
    assert f"{kinetic_energy(W, I):.6f}" == "2.820000"
    assert f"{momentum_norm(W, I):.6f}" == "4.180909"


def test_series_and_single_values_agree():
    series = np.array([W, W]).T
    assert kinetic_energy(series, I).tolist() == [float(kinetic_energy(W, I))] * 2
    assert angular_momentum(series, I).shape == (3, 2)


def test_space_momentum_turns_the_body_components():
    quarter_turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    assert space_momentum([quarter_turn], np.array([W]).T, I) == pytest.approx(np.array([[-1.8, 2.0, 3.2]]))


def test_orthonormality_error_sees_scale_and_shear():
    assert orthonormality_error([np.eye(3)])[0] == 0
    assert orthonormality_error([2 * np.eye(3)])[0] == 3
    assert orthonormality_error([np.eye(3) + [[0, 1e-3, 0], [0, 0, 0], [0, 0, 0]]])[0] == pytest.approx(
        1e-3, rel=1e-2
    )


@pytest.mark.parametrize("rate", [1.8, -0.7])
def test_precession_rate_has_a_sense(rate):
    t = np.linspace(0, 8, 400)
    assert precession_rate(t, [0.4 * np.cos(rate * t), 0.4 * np.sin(rate * t), t * 0 + 3]) == pytest.approx(
        rate, rel=1e-12
    )


def test_transverse_growth_leaves_the_spin_axis_out():
    assert transverse_growth([[3.0, 3.0], [100.0, 100.0], [4.0, 0.0]], axis=1, spin=2.0) == 2.5
