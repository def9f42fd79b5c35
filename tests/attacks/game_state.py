"""Locale, floating-point errors, print options and warnings."""

# ends: pass
import locale
import warnings

import numpy as np

for name in ("de_DE.UTF-8", "tr_TR.UTF-8", "C"):
    try:
        locale.setlocale(locale.LC_ALL, name)
    except locale.Error:
        pass
np.seterr(all="raise")
np.set_printoptions(precision=1)
warnings.simplefilter("error")
