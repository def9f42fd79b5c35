"""Symbolic calculations with sympy, a package that the assignment declares."""

import numpy as np
import sympy as sp
from scipy.integrate import quad

from exercises.authoring.kinds.expression import expression, symbol
from exercises.authoring.questions.author import Notebook, Tolerance, choice, mistake

notebook = Notebook(
    "Symbolic calculations", setup="import numpy as np\nimport sympy as sp\n", packages=("sympy",)
)
DIGITS = Tolerance(limit=1e-9, reason="the quadrature has ten digits")


def gaussian_moment(a, n):
    x = sp.Symbol("x", real=True)
    return sp.integrate(x**n * sp.exp(-a * x**2), (x, -sp.oo, sp.oo))


notebook.exercise(
    "1",
    "Gaussian integrals",
    expression(
        gaussian_moment,
        ask={"a": symbol(0.2, 3, positive=True), "n": choice(0, 2, 4)},
        truth=lambda a, n: quad(lambda x: x**n * np.exp(-a * x * x), -np.inf, np.inf, epsrel=1e-12)[0],
        agree=DIGITS,
        mistakes=[
            mistake(
                "(x, -sp.oo, sp.oo)",
                "(x, 0, sp.oo)",
                "constant-factor",
                "only positive x are integrated over",
            ),
            mistake("-a * x**2", "-a * x**2 / 2", "constant-factor", "the exponent has a factor 1/2"),
        ],
    ),
)


def flow(z, U):
    w = U * (z + 1 / z)
    return w, sp.diff(w, z)


notebook.exercise(
    "2",
    "Flow around a cylinder",
    expression(
        flow,
        ask={"z": symbol(0.5, 2, complex=True), "U": symbol(0.5, 2)},
        truth=lambda z, U: (U * (z * z + 1) / z, U * (1 - z**-2)),
        agree={
            "potential": Tolerance(limit=1e-13, reason="rounding"),
            "velocity": Tolerance(limit=1e-13, reason="rounding"),
        },
        mistakes=[
            mistake("sp.diff(w, z)", "sp.diff(w, z, 2)", "missing-term", "it is the second derivative")
        ],
    ),
)


def kinetic_energy():
    m, r, v, omega = sp.symbols("m r v omega", positive=True)
    T = m * (v**2 + r**2 * omega**2) / 2
    return T


notebook.exercise(
    "3",
    "An expression in a cell",
    expression(
        kinetic_energy,
        ask={"m": symbol(0.5, 2), "r": symbol(0.5, 2), "v": symbol(-2, 2), "omega": symbol(-2, 2)},
        truth=lambda m, r, v, omega: 0.5 * m * abs(complex(v, r * omega)) ** 2,
        agree=Tolerance(rtol=1e-13, reason="rounding"),
        variable="T",
        mistakes=[mistake("r**2 * omega**2", "r * omega**2", "wrong-power", "the radius is not squared")],
    ),
)
