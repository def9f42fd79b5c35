"""The notebook's Setup cell."""

import numpy as np

POINTS = np.loadtxt("points.csv")
