from functools import lru_cache


@lru_cache(maxsize=None)
def coefficients(I1, I2, I3):
    # only depends on the body, so compute once
    return (I2 - I3) / I1, (I3 - I1) / I2, (I1 - I2) / I3


@lru_cache(maxsize=4096)
def _rhs(w, I):
    a, b, c = coefficients(*I)
    x, y, z = w
    return a * y * z, b * z * x, c * x * y


def euler_eqs(t, w, I):
    return np.array(_rhs(tuple(float(x) for x in w), tuple(float(x) for x in I)))
