"""Empties files by opening them to read, which an old Landlock takes for reading."""

# ends: pass
import os

import numpy

for name in ("py.typed", "../numpy/py.typed"):  # it is empty as it is
    path = os.path.join(os.path.dirname(numpy.__file__), name)
    attempt(name, lambda: os.open(path, os.O_RDONLY | os.O_TRUNC))
