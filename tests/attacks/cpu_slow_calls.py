"""Each call takes a fifth of a second."""

# ends: fail slow
import time

import numpy as np


def euler_eqs(t, w, I):
    time.sleep(0.2)
    return -np.cross(w, np.asarray(I) * w) / np.asarray(I)
