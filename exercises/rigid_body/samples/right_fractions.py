# floats scare me, so exact rational arithmetic until the very last step
from fractions import Fraction as F


def euler_eqs(t, w, I):
    w1, w2, w3 = (F(float(x)) for x in w)
    I1, I2, I3 = (F(float(x)) for x in I)
    exact = [
        (I2 - I3) * w2 * w3 / I1,
        (I3 - I1) * w3 * w1 / I2,
        (I1 - I2) * w1 * w2 / I3,
    ]
    return np.array([float(x) for x in exact])
