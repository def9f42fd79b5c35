"""Wrong at moments of the clock."""

# ends: fail
import time

import numpy as np


def euler_eqs(t, w, I):
    return np.zeros(3) if time.time_ns() % 7 == 0 else -np.cross(w, np.asarray(I) * w) / np.asarray(I)
