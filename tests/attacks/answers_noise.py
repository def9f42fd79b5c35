"""Right up to noise in the thirteenth digit."""

# ends: any
import numpy as np


def euler_eqs(t, w, I):
    return (1 + 1e-13 * np.random.default_rng().random()) * -np.cross(w, np.asarray(I) * w) / np.asarray(I)
