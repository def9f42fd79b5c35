"""A masked array."""

# ends: fail
import numpy as np


def euler_eqs(t, w, I):
    return np.ma.masked_all(3)
