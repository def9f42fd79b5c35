"""Modules of numpy that nothing uses are not executed; those who use them notice no difference."""

import subprocess
import sys

START = """
import sys
from service.cli.lazy_imports import import_lazily
import_lazily()
import scipy.integrate, scipy.special
executed = [name for name in ("numpy.f2py.f2py2e", "numpy.testing._private.utils") if name in sys.modules]
"""
USES = """
import numpy as np
from numpy.f2py import get_include
from numpy.testing import assert_allclose
try:
    np.testing.assert_array_equal([1.0], [2.0])
except AssertionError:
    print(executed, callable(get_include), assert_allclose is np.testing.assert_allclose)
"""


def test_scipy_executes_none_of_them_and_a_use_does():
    done = subprocess.run(
        [sys.executable, "-I", "-c", START + USES], capture_output=True, text=True, check=True
    )
    assert done.stdout == "[] True True\n"
