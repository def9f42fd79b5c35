"""Infinities."""

# ends: fail
import numpy as np


def euler_eqs(t, w, I):
    return np.array([np.inf, -np.inf, np.inf])
