"""Real numbers as complex ones."""

# ends: pass
import numpy as np


def euler_eqs(t, w, I):
    return -np.cross(w, np.asarray(I) * w) / np.asarray(I) + 0j
