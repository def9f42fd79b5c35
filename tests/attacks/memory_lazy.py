"""Forty gigabytes that cost nothing until they are touched."""

# ends: fail
import numpy as np

a = np.zeros(5 * 10**9)
a[::512] = 1
print("ESCAPED", a.nbytes)
