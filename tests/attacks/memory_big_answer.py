"""An answer of a hundred million numbers."""

# ends: fail
import numpy as np


def euler_eqs(t, w, I):
    return np.zeros(30_000_000)
