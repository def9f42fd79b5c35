"""An empty array."""

# ends: fail
import numpy as np


def euler_eqs(t, w, I):
    return np.zeros(0)
