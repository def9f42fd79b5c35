import math
import numpy as xp


def euler_eqs(t, w, I):
    pairs = [(1, 2), (2, 0), (0, 1)]
    rhs = [(I[j] - I[k]) * math.prod((w[j], w[k])) for j, k in pairs]
    return xp.true_divide(rhs, I)
