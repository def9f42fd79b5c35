"""Discrete Moser-Veselov for a torque-free body, preprocessed to order 6: an integrable map on modified
moments.

1/Ĩᵢ = (1 + s)/Iᵢ + d, with s and d polynomials in h²|L|²/2 and h²T (Hairer & Vilmart, J. Phys. A 39, 2006,
whose coefficients these are). The map itself is Moser & Veselov's (Comm. Math. Phys. 139, 1991), in
quaternions.
"""

import numpy as np
from numba import njit

from reference.methods.splitting import normalise, turning
from reference.methods.states import Array

MOST_ITERATIONS = 60


@njit(cache=True)
def _modified(I: Array, c: float, e: float) -> Array:
    """Return 1/Ĩ for c = h²|L|²/2 and e = h²T."""
    inverse, inverse2 = np.sum(1 / I), np.sum(1 / (I * I))
    total, total2, product = np.sum(I), np.sum(I * I), I[0] * I[1] * I[2]
    ratios = (I[0] + I[1]) / I[2] + (I[1] + I[2]) / I[0] + (I[2] + I[0]) / I[1]
    s = total / (6 * product) * c - inverse / 3 * e
    d = -c / (3 * product) + total / (6 * product) * e
    s += (total2 / product - inverse) / (30 * product) * c * c + (1 - ratios) / (30 * product) * c * e
    s += (3 * total / product + 2 * inverse2) / 60 * e * e
    d += -total / (60 * product**2) * c * c + (inverse / 10 - total2 / (60 * product)) / product * c * e
    d -= (9 + ratios) / (60 * product) * e * e
    return (1 + s) / I + d


@njit(cache=True)
def _map(m: Array, p: Array, I: Array, mgl: float, h: float, steps: int, out: Array) -> int:
    inverse = _modified(I, 0.5 * h * h * np.sum(m * m), 0.5 * h * h * np.sum(m * m / I))
    modified = 1 / inverse
    gap = np.array([modified[1] - modified[2], modified[2] - modified[0], modified[0] - modified[1]])
    calls, v = 0, np.empty(3)
    for at in range(1, len(out)):
        for _ in range(steps):
            half = 0.5 * h * m * inverse
            v[:] = half
            last = np.inf
            for _ in range(MOST_ITERATIONS):
                length = 1 + v[0] * v[0] + v[1] * v[1] + v[2] * v[2]
                change = 0.0
                for i in range(3):
                    j, k = (i + 1) % 3, (i + 2) % 3
                    fresh = length * half[i] + gap[i] * inverse[i] * v[j] * v[k]
                    change = max(change, abs(fresh - v[i]))
                    v[i] = fresh
                calls += 1
                if change == 0.0 or (change < 1e-12 and change >= last):
                    break
                last = change
            (a, b, c, d), (x, y, z) = p, v
            p[0], p[1] = a - b * x - c * y - d * z, b + a * x + c * z - d * y
            p[2], p[3] = c + a * y - b * z + d * x, d + a * z + b * y - c * x
            normalise(p)
            scale = 4 / (h * (1 + v[0] * v[0] + v[1] * v[1] + v[2] * v[2]))
            m[0] += gap[0] * v[1] * v[2] * scale
            m[1] += gap[1] * v[2] * v[0] * scale
            m[2] += gap[2] * v[0] * v[1] * scale
        out[at, :3], out[at, 3:] = m, p
    return calls


MOSER_VESELOV = (turning("Moser-Veselov 6", 6, _map),)
