"""Its answers hang on the process they are asked in."""

# ends: fail
import os

import numpy as np


def euler_eqs(t, w, I):
    return (1 + 1e-12 * (id(object()) % 64 + os.getpid())) * -np.cross(w, np.asarray(I) * w) / np.asarray(I)
