"""The elliptic integral of the third kind against fifty digits, on both sides of where it is reduced."""

import mpmath as mp
import numpy as np
import pytest

from reference.elliptic import jacobi, third_kind

SHARES = np.array([1e-12, 1e-6, 1e-3, 0.1, 0.5, 0.9, 0.999])


@pytest.mark.parametrize("kc", [1.0, 0.9, 0.3, 1e-3])
@pytest.mark.parametrize("nc", [0.5, 1.5, 2.0, 2.5, 1e3, 1e10, 1e20])
def test_the_third_kind_keeps_every_digit(kc, nc):
    with mp.workdps(50):
        m = 1 - mp.mpf(kc) ** 2
        quarter = mp.ellipk(m)
        x = float(quarter) * SHARES
        truth = [float(mp.ellippi(1 - mp.mpf(nc), mp.asin(mp.ellipfun("sn", mp.mpf(u), m=m)), m)) for u in x]
    np.testing.assert_allclose(third_kind(jacobi(x, kc), 1 - nc, nc, kc), truth, rtol=3e-15)


def test_a_quarter_period_that_rounding_takes_beyond_k():
    kc, nc = 0.47942553860420634, 1e14
    with mp.workdps(50):
        m = 1 - mp.mpf(kc) ** 2
        quarter, complete = float(mp.ellipk(m)), float(mp.ellippi(1 - mp.mpf(nc), m))
    for x in (np.nextafter(quarter, 9.0), quarter, np.nextafter(quarter, 0.0)):
        assert third_kind(jacobi(np.array([x]), kc), 1 - nc, nc, kc)[0] == pytest.approx(complete, rel=1e-14)
