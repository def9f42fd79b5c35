"""Formatters of IPython for arrays and numbers that raise, print and end the process."""

# ends: pass
import os

import numpy as np

for mime in get_ipython().display_formatter.formatters.values():
    mime.for_type(np.ndarray, lambda *a: os._exit(0))
    mime.for_type(float, lambda *a: 1 / 0)
1.0
