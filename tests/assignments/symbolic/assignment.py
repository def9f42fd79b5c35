"""Symbolic calculations with sympy, a package that the assignment declares."""

import numpy as np
from scipy.integrate import quad

from exercises.authoring import Notebook, close, one_of, relative, symbol

notebook = Notebook("notebook.ipynb", packages=("sympy",))


@notebook.exercise("1")
def gaussian_integrals(ask):
    moment = ask.symbolic("gaussian_moment")
    moment.case("any width", a=symbol(0.2, 3, positive=True), n=one_of(0, 2, 4))

    @moment.truth(agree=relative(1e-9, because="the quadrature has ten digits"))
    def by_quadrature(a, n):
        return quad(lambda x: x**n * np.exp(-a * x * x), -np.inf, np.inf, epsrel=1e-12)[0]

    moment.mistake(
        "constant-factor", "only positive x are integrated over", change="(x, -sp.oo, sp.oo) -> (x, 0, sp.oo)"
    )
    moment.mistake("constant-factor", "the exponent has a factor 1/2", change="-a * x**2 -> -a * x**2 / 2")


@notebook.exercise("2")
def flow_around_a_cylinder(ask):
    flow = ask.symbolic("flow", returns="potential velocity")
    flow.case("any flow", z=symbol(0.5, 2, complex=True), U=symbol(0.5, 2))

    @flow.truth(agree=relative(1e-13, because="rounding"))
    def by_hand(z, U):
        return U * (z * z + 1) / z, U * (1 - z**-2)

    flow.mistake("missing-term", "it is the second derivative", change="sp.diff(w, z) -> sp.diff(w, z, 2)")


@notebook.exercise("3")
def an_expression_in_a_cell(ask):
    energy = ask.symbolic("T")
    energy.case("any motion", m=symbol(0.5, 2), r=symbol(0.5, 2), v=symbol(-2, 2), omega=symbol(-2, 2))

    @energy.truth(agree=close(rtol=1e-13, atol=0.0, because="rounding"))
    def of_the_velocity(m, r, v, omega):
        return 0.5 * m * abs(complex(v, r * omega)) ** 2

    energy.mistake("wrong-power", "the radius is not squared", change="r**2 * omega -> r * omega")
