"""Gauss collocation on (ω, R), solved by fixed-point iteration. It conserves every quadratic invariant: T,
|L|², RᵀR.
"""

from functools import partial

import numpy as np
from numba import njit

from reference.method import Array, fixed
from reference.methods.explicit import advance, keep, rates, start

MOST_ITERATIONS = 60


def tableau(stages: int) -> tuple[Array, Array]:
    """Return A (s, s) and b (s,) of the Gauss method with s = ``stages``.

    Source: Hairer, Lubich & Wanner, Geometric Numerical Integration, §II.1.3.
    """
    node, weight = np.polynomial.legendre.leggauss(stages)
    c, b = (node + 1) / 2, weight / 2
    powers = c[:, None] ** np.arange(stages)
    integrals = c[:, None] ** np.arange(1, stages + 1) / np.arange(1, stages + 1)
    return np.ascontiguousarray(integrals @ np.linalg.inv(powers)), b


@njit(cache=True)
def _gauss(
    A: Array, b: Array, w0: Array, I: Array, h: float, intervals: int, steps: int, w: Array, R: Array
) -> int:
    stages = b.size
    y, k, fresh, point = start(w0), np.zeros((stages, 12)), np.empty((stages, 12)), np.empty(12)
    keep(y, 0, w, R)
    calls = 0
    for at in range(1, intervals + 1):
        for _ in range(steps):
            last = np.inf
            for _ in range(MOST_ITERATIONS):
                change = 0.0
                for s in range(stages):
                    advance(y, h, A[s], k, point)
                    rates(point, I, fresh[s])
                calls += stages
                for s in range(stages):
                    for i in range(12):
                        change = max(change, abs(fresh[s, i] - k[s, i]))
                        k[s, i] = fresh[s, i]
                if change == 0.0 or (change < 1e-12 and change >= last):
                    break
                last = change
            advance(y, h, b, k, y)
        keep(y, at, w, R)
    return calls


GAUSS = tuple(
    fixed(name, "implicit", 2 * stages, partial(_gauss, *tableau(stages)))
    for name, stages in (("implicit midpoint", 1), ("Gauss 4", 2), ("Gauss 12", 6))
)
