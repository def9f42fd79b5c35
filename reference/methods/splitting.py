"""Splitting into rotations about the three principal axes, each solved exactly, composed to order 2, 4, 6 and
8.

T = Σ Lᵢ²/2Iᵢ is a sum of three parts, and under one of them the body turns about ê ᵢ at Lᵢ/Iᵢ (McLachlan,
1993; Reich, 1994).
"""

from functools import partial

import numpy as np
from numba import njit

from reference.method import Array, fixed
from reference.methods.rotation import keep, normalise, start, turn

_FIFTH = 1 / (4 - 4 ** (1 / 3))
STRANG = np.array([1.0])
SUZUKI4 = np.array([_FIFTH, _FIFTH, 1 - 4 * _FIFTH, _FIFTH, _FIFTH])  # Suzuki, 1990
# Kahan & Li, Math. Comp. 66 (1997): s9odr6a and s17odr8a, first half and middle.
_SIX = [
    0.39216144400731413928,
    0.33259913678935943860,
    -0.70624617255763935981,
    0.08221359629355080023,
    0.79854399093482996340,
]
_EIGHT = [
    0.13020248308889008088,
    0.56116298177510838456,
    -0.38947496264484728641,
    0.15884190655515560090,
    -0.39590389413323757734,
    0.18453964097831570709,
    0.25837438768632204729,
    0.29501172360931029887,
    -0.60550853383003451170,
]
KAHAN_LI_6, KAHAN_LI_8 = (np.array([*half, *half[-2::-1]]) for half in (_SIX, _EIGHT))


@njit(cache=True)
def _splitting(
    gammas: Array, w0: Array, I: Array, h: float, intervals: int, steps: int, w: Array, R: Array
) -> int:
    m, p = start(w0, I)
    keep(m, p, I, 0, w, R)
    for at in range(1, intervals + 1):
        for _ in range(steps):
            for gamma in gammas:
                g = gamma * h
                turn(m, p, 0.5 * g * m[0] / I[0], 0.0, 0.0)
                turn(m, p, 0.0, 0.5 * g * m[1] / I[1], 0.0)
                turn(m, p, 0.0, 0.0, g * m[2] / I[2])
                turn(m, p, 0.0, 0.5 * g * m[1] / I[1], 0.0)
                turn(m, p, 0.5 * g * m[0] / I[0], 0.0, 0.0)
            normalise(p)
        keep(m, p, I, at, w, R)
    return int(intervals * steps * gammas.size)


SPLITTING = tuple(
    fixed(name, "splitting", order, partial(_splitting, gammas))
    for name, order, gammas in (
        ("Strang splitting", 2, STRANG),
        ("splitting 4", 4, SUZUKI4),
        ("splitting 6", 6, KAHAN_LI_6),
        ("splitting 8", 8, KAHAN_LI_8),
    )
)
