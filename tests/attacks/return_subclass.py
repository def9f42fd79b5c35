"""An array type with rules of its own."""

# ends: fail
import numpy as np


class Sly(np.ndarray):
    @property
    def shape(self):
        return (3,)


def euler_eqs(t, w, I):
    return np.zeros(1).view(Sly)
