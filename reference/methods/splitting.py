"""Splitting into rotations about the three principal axes and kicks by the torque, each solved exactly,
composed to order 2 and 6.

T = Σ Lᵢ²/2Iᵢ is a sum of three parts, and under one of them the body turns about êᵢ at Lᵢ/Iᵢ (McLachlan,
1993; Reich, 1994). The state is body momentum (3,) and attitude as a quaternion (4,), which are turned
instead of added to.
"""

import math
from collections.abc import Callable
from functools import partial

import numpy as np
from numba import njit

from reference.methods.method import Method, Run, Scene
from reference.methods.runge_kutta import STEPS
from reference.methods.states import QUATERNION, Array, run_of, start

STRANG = np.array([1.0])
# Kahan & Li, Math. Comp. 66 (1997): s9odr6a, first half and middle.
_SIX = [
    0.39216144400731413928,
    0.33259913678935943860,
    -0.70624617255763935981,
    0.08221359629355080023,
    0.79854399093482996340,
]
KAHAN_LI_6 = np.array([*_SIX, *_SIX[-2::-1]])


@njit(cache=True)
def normalise(p: Array) -> None:
    """Normalize p in place, which only removes rounding."""
    p /= math.sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3])


@njit(cache=True)
def _turn(m: Array, p: Array, axis: int, angle: float) -> None:
    """Turn the body by ``angle`` in rad about a principal axis: the attitude p, and the momentum's components
    back.
    """
    j, k = (axis + 1) % 3, (axis + 2) % 3
    c, s = math.cos(angle), math.sin(angle)
    m[j], m[k] = c * m[j] + s * m[k], c * m[k] - s * m[j]
    c, s = math.cos(angle / 2), math.sin(angle / 2)
    p[0], p[1 + axis] = c * p[0] - s * p[1 + axis], c * p[1 + axis] + s * p[0]
    p[1 + j], p[1 + k] = c * p[1 + j] + s * p[1 + k], c * p[1 + k] - s * p[1 + j]


@njit(cache=True)
def _kick(m: Array, p: Array, impulse: float) -> None:
    """Add the torque times a time, ``impulse`` in N m s, to the momentum m."""
    m[0] += impulse * 2 * (p[2] * p[3] + p[0] * p[1])
    m[1] -= impulse * 2 * (p[1] * p[3] - p[0] * p[2])


@njit(cache=True)
def _splitting(
    gammas: Array, m: Array, p: Array, I: Array, mgl: float, h: float, steps: int, out: Array
) -> int:
    for at in range(1, len(out)):
        for _ in range(steps):
            for gamma in gammas:
                g = gamma * h
                _kick(m, p, 0.5 * g * mgl)
                _turn(m, p, 0, 0.5 * g * m[0] / I[0])
                _turn(m, p, 1, 0.5 * g * m[1] / I[1])
                _turn(m, p, 2, g * m[2] / I[2])
                _turn(m, p, 1, 0.5 * g * m[1] / I[1])
                _turn(m, p, 0, 0.5 * g * m[0] / I[0])
                _kick(m, p, 0.5 * g * mgl)
            normalise(p)
        out[at, :3], out[at, 3:] = m, p
    return int((len(out) - 1) * steps * gammas.size)


def turning(name: str, order: int, kernel: Callable[..., int]) -> Method:
    """Return a method from a compiled ``kernel(m, p, I, mgl, h, steps, out)``, which fills the states ``out``
    (n, 7), m and p, from the second on and returns the number of calls.
    """

    def run(scene: Scene, steps: float) -> Run:
        begun, I = start(scene, QUATERNION), np.array(scene.I)
        states, h = np.empty((scene.intervals + 1, 7)), scene.t_end / (scene.intervals * steps)
        states[0] = *(begun[:3] * I), *begun[3:]
        calls = kernel(states[0, :3].copy(), begun[3:], I, scene.mgl, h, int(steps), states)
        states[:, :3] /= I
        return run_of(QUATERNION, states, calls)

    return Method(name, order, STEPS, run)


SPLITTING = (
    turning("Strang splitting", 2, partial(_splitting, STRANG)),
    turning("splitting 6", 6, partial(_splitting, KAHAN_LI_6)),
)
