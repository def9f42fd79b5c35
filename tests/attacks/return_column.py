"""A column instead of a row."""

# ends: fail
import numpy as np


def euler_eqs(t, w, I):
    return (-np.cross(w, np.asarray(I) * w) / np.asarray(I)).reshape(3, 1)
