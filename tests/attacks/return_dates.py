"""Dates."""

# ends: fail
import numpy as np


def euler_eqs(t, w, I):
    return np.array(["2020", "2021", "2022"], dtype="M8[s]")
