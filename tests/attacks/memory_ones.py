"""A hundred gigabytes at once."""

# ends: fail
import numpy as np

np.ones(10**10 + 10**9)
