"""Poisons modules, builtins, seeds and defaults in memory."""

# ends: any
import builtins
import random
import sys

import matplotlib
import numpy as np

builtins.poisoned = True
matplotlib.rcParams["figure.dpi"] = 7
np.random.seed(3)
random.seed(3)
sys.modules["poisoned"] = sys
np.linalg.norm = lambda *a, **k: 0.0
