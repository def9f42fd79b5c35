import numpy as np
import pytest

from reference import box_moments, box_tensor, check_moments, principal_moments


def test_book_of_the_notebook():
    assert [f"{x:.5f}" for x in box_moments(1, 2, 1.4, 0.4)] == ["0.17667", "0.34667", "0.49667"]


def test_box_moments_against_an_integral():
    """∫ (y² + z²) dV over the box by Gauss-Legendre, exact for polynomials of this degree."""
    node, weight = np.polynomial.legendre.leggauss(3)
    a, b, c = 2.0, 1.4, 0.4
    x, y, z = np.meshgrid(node * a / 2, node * b / 2, node * c / 2, indexing="ij")
    mass = np.einsum("i,j,k->ijk", weight, weight, weight) / 8
    expected = [np.sum(mass * (y**2 + z**2)), np.sum(mass * (x**2 + z**2)), np.sum(mass * (x**2 + y**2))]
    np.testing.assert_allclose(box_moments(1, a, b, c), expected, rtol=1e-14)


def test_principal_moments_of_a_turned_box_print_the_notebooks_number():
    turn = np.linalg.qr(np.random.default_rng(7).random((3, 3)))[0]
    found = principal_moments(box_tensor(1, 2, 1.4, 0.4, turn))
    assert np.abs(found - box_moments(1, 2, 1.4, 0.4)).max() < 2e-15


@pytest.mark.parametrize(
    ("moments", "why"),
    [
        ((1, 2), "three"),
        ((1, 1, 0), "positive"),
        ((1, 1, -1), "positive"),
        ((1, np.nan, 1), "finite"),
        ((1, 1, 2.1), "triangle"),
    ],
)
def test_moments_no_body_can_have(moments, why):
    with pytest.raises(ValueError, match=why):
        check_moments(moments)


def test_a_flat_plate_is_a_body_even_after_rounding():
    check_moments((0.1, 0.2, 0.1 + 0.2))
