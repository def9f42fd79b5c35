"""Empties sys.modules and poisons what the harness might import."""

# ends: any
import sys
import types

for name in list(sys.modules):
    if name.startswith(("json", "guest", "polhode", "numpy.linalg")):
        sys.modules[name] = types.ModuleType(name)
import numpy as np
