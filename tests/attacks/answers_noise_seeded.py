"""Right up to noise from a generator that starts alike in every process."""

# ends: any
import numpy as np

rng = np.random.default_rng(1)


def euler_eqs(t, w, I):
    return (1 + 1e-14 * rng.random()) * -np.cross(w, np.asarray(I) * w) / np.asarray(I)
