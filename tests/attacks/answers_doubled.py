"""Twice the rate: energy and momentum are conserved all the same."""

# ends: fail
import numpy as np


def euler_eqs(t, w, I):
    return -2 * np.cross(w, np.asarray(I) * w) / np.asarray(I)
