"""The notebook's Setup cell: these names are in scope for every submission."""

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import solve_ivp

import ecp
from ecp import validate

__all__ = ["ecp", "np", "plt", "solve_ivp", "validate"]
