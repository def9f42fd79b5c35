"""Right to single precision."""

# ends: fail
import numpy as np


def euler_eqs(t, w, I):
    w, I = np.asarray(w, dtype=np.float32), np.asarray(I, dtype=np.float32)
    return (-np.cross(w, I * w) / I).astype(float)
