"""Matrix products without end."""

# ends: fail slow
import numpy as np


def euler_eqs(t, w, I):
    a = np.ones((1500, 1500))
    while True:
        a = a @ a * 1e-9
