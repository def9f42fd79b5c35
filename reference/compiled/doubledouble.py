"""Double-double arithmetic, 32 digits, on pairs (high, low) (Dekker 1971; Knuth, TAOCP 2, §4.2.2; Hida, Li &
Bailey 2001).
"""

import math
from typing import TypeAlias

from numba import njit

DD: TypeAlias = tuple[float, float]
SPLIT = 134217729.0
compiled = njit(cache=True, error_model="numpy")


@compiled
def product(a: float, b: float) -> DD:
    """Return a·b exactly."""
    c = SPLIT * a
    a1 = c - (c - a)
    a2 = a - a1
    c = SPLIT * b
    b1 = c - (c - b)
    b2 = b - b1
    p = a * b
    return p, ((a1 * b1 - p) + a1 * b2 + a2 * b1) + a2 * b2


@compiled
def total(a: float, b: float) -> DD:
    """Return a + b exactly."""
    s = a + b
    z = s - a
    return s, (a - (s - z)) + (b - z)


@compiled
def add(a: DD, b: DD) -> DD:
    """Return a + b."""
    s, e = total(a[0], b[0])
    t, f = total(a[1], b[1])
    e += t
    h = s + e
    e = e - (h - s) + f
    r = h + e
    return r, e - (r - h)


@compiled
def neg(a: DD) -> DD:
    """Return −a."""
    return -a[0], -a[1]


@compiled
def sub(a: DD, b: DD) -> DD:
    """Return a − b."""
    return add(a, neg(b))


@compiled
def mul(a: DD, b: DD) -> DD:
    """Return a·b."""
    p, e = product(a[0], b[0])
    e += a[0] * b[1] + a[1] * b[0]
    r = p + e
    return r, e - (r - p)


@compiled
def times(a: DD, k: float) -> DD:
    """Return a·k for a double k."""
    p, e = product(a[0], k)
    e += a[1] * k
    r = p + e
    return r, e - (r - p)


@compiled
def div(a: DD, b: DD) -> DD:
    """Return a / b by two corrections."""
    first = a[0] / b[0]
    rest = sub(a, times(b, first))
    second = rest[0] / b[0]
    rest = sub(rest, times(b, second))
    s, e = total(first, second)
    return add((s, e), (rest[0] / b[0], 0.0))


@compiled
def root(a: DD) -> DD:
    """Return √a for a ≥ 0."""
    if a[0] <= 0.0:
        return 0.0, 0.0
    x = math.sqrt(a[0])
    rest = sub(a, product(x, x))
    return add((x, 0.0), (rest[0] / (2 * x), 0.0))
