"""Right only at early times."""

# ends: fail
import numpy as np


def euler_eqs(t, w, I):
    return np.zeros(3) if t > 1 else -np.cross(w, np.asarray(I) * w) / np.asarray(I)
