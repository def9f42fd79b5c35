"""Sends each of the harness's frames twice."""

# ends: fail
import os

write = os.write


def twice(fd, data):
    if fd == RESULT:
        write(fd, data)
    return write(fd, data)


os.write = twice
import numpy as np


def euler_eqs(t, w, I):
    return -np.cross(w, np.asarray(I) * w) / np.asarray(I)
