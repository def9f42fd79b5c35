"""Numerical methods for the torque-free body and the heavy top, to chart what they cost and where they fail
against the exact solution.

Each family is one file with a table of coefficients and one algorithm. The kernels are compiled with numba,
because otherwise a chart of CPU time would measure the interpreter; ``import reference`` does not import this
package.
"""

from reference.methods.method import Method, Run, Scene
from reference.methods.moser_veselov import MOSER_VESELOV
from reference.methods.runge_kutta import RUNGE_KUTTA
from reference.methods.splitting import SPLITTING

HEAVY: tuple[Method, ...] = (*RUNGE_KUTTA, *SPLITTING)
METHODS: tuple[Method, ...] = (*HEAVY, *MOSER_VESELOV)

__all__ = ["HEAVY", "METHODS", "Method", "Run", "Scene"]
