import numpy as np

from reference import attitude_rate, euler_rhs


def test_each_component_has_its_own_pair():
    assert euler_rhs((1.0, 2.0, 3.0), (2.0, 3.0, 4.0)).tolist() == [
        (3 - 4) * 2 * 3 / 2,
        (4 - 2) * 3 * 1 / 3,
        (2 - 3) * 1 * 2 / 4,
    ]


def test_rate_is_minus_omega_cross_l_over_i():
    rng = np.random.default_rng(1)
    w, moments = rng.normal(size=(3, 50)), rng.uniform(1, 2, 3)
    expected = -np.cross(w, moments[:, None] * w, axis=0) / moments[:, None]
    np.testing.assert_allclose(euler_rhs(w, moments), expected, rtol=0, atol=1e-14)


def test_attitude_turns_about_omega():
    rate = attitude_rate(np.eye(3), (0.0, 0.0, 2.0))
    assert (rate @ [1.0, 0.0, 0.0]).tolist() == [0.0, 2.0, 0.0]
    assert (rate + rate.T == 0).all()
