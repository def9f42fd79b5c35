"""Wrong only after 200 calls."""

# ends: fail
import numpy as np

calls = []


def euler_eqs(t, w, I):
    calls.append(t)
    return np.zeros(3) if len(calls) > 200 else -np.cross(w, np.asarray(I) * w) / np.asarray(I)
