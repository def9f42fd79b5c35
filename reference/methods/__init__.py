"""Numerical methods for the torque-free body and, in ``HEAVY``, for the heavy top, to chart what they cost
and where they fail against the exact solution.

Each family is one file with a table of coefficients and one algorithm. Fixed-step kernels are compiled with
numba, because otherwise a chart of CPU time would measure the interpreter; ``import reference`` does not
import this package.
"""

from reference.method import Method, Run, Scene
from reference.methods.adaptive import ADAPTIVE
from reference.methods.closed import CLOSED
from reference.methods.explicit import EXPLICIT
from reference.methods.gauss import GAUSS
from reference.methods.heavy import HEAVY
from reference.methods.liegroup import LIEGROUP
from reference.methods.moser_veselov import MOSER_VESELOV
from reference.methods.splitting import SPLITTING

METHODS: tuple[Method, ...] = (*EXPLICIT, *GAUSS, *SPLITTING, *LIEGROUP, *MOSER_VESELOV, *ADAPTIVE, CLOSED)

__all__ = ["HEAVY", "METHODS", "Method", "Run", "Scene"]
