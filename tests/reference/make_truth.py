"""Make truth.npz: ω and R of more than two thousand bodies to sixty digits, by formulas other than the ones
under test.

Here the attitude comes from the azimuth of L's meridian and the incomplete integral Π(n; φ, m), and cn, sn,
dn from mpmath (Landau & Lifshitz §37; Whittaker, Analytical Dynamics, §69); `reference.exact` uses
shortest-arc quaternions and theta series. Run ``python tests/reference/make_truth.py``; it takes about two
minutes on one core.
"""

import sys
from pathlib import Path

import mpmath as mp
import numpy as np

HERE = Path(__file__).parent
PER_FAMILY = 350
TIMES = 2
FAMILIES = ("generic", "separatrix", "tennis", "near-symmetric", "rod", "near-steady")


def draw(family: str, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Moments and spin of a physical body of the family, as doubles."""
    edges = rng.uniform(0.2, 2.0, 3)
    moments = np.array(
        [edges[1] ** 2 + edges[2] ** 2, edges[0] ** 2 + edges[2] ** 2, edges[0] ** 2 + edges[1] ** 2]
    )
    order = np.argsort(moments)
    low, mid, high = order
    spin = rng.normal(size=3)
    small = 10.0 ** rng.uniform(-14, -2)
    if family == "separatrix":
        gap = (
            moments[low]
            * spin[low] ** 2
            * (moments[mid] - moments[low])
            / (moments[high] * (moments[high] - moments[mid]))
        )
        spin[high] = np.sqrt(gap) * (1 + small * rng.choice([-1, 1])) * rng.choice([-1, 1])
    elif family == "tennis":
        spin = rng.normal(size=3) * small
        spin[mid] = rng.choice([-1, 1]) * rng.uniform(1, 6)
    elif family == "near-symmetric":
        close = 10.0 ** rng.uniform(-15, -2)
        moments[mid] = moments[rng.choice([low, high])] * (1 + close)
        moments[high] = min(moments[high], 0.99 * (moments[low] + moments[mid]))
    elif family == "rod":
        thin = 10.0 ** rng.uniform(-6, -1)
        moments = rng.permutation([thin, 1.0, 1.0 + thin * rng.uniform(-0.9, 0.9)])
        spin = rng.normal(size=3) * np.where(rng.random() < 0.5, 1.0, 1 / np.sqrt(moments))
    elif family == "near-steady":
        axis = rng.choice([low, high])
        spin = rng.normal(size=3) * small
        spin[axis] = rng.choice([-1, 1]) * rng.uniform(1, 6)
    return moments, spin


def truth(
    moments: np.ndarray, spin: np.ndarray, phases: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times (n,) at those numbers of periods, ω (n, 3) and R (n, 3, 3), rounded from sixty digits."""
    with mp.workdps(60):
        body = _Body([mp.mpf(float(x)) for x in moments], [mp.mpf(float(x)) for x in spin])
        times = np.array([float(p * body.period) for p in phases])
        values = [body.at(mp.mpf(t)) for t in times]
    omega = np.array([[float(x) for x in w] for w, _ in values])
    attitude = np.array([[[float(R[i, j]) for j in range(3)] for i in range(3)] for _, R in values])
    return times, omega, attitude


class _Body:
    def __init__(self, I, w):
        order = sorted(range(3), key=lambda i: I[i])
        m = [I[i] * w[i] for i in range(3)]
        square, twice = sum(x * x for x in m), sum(m[i] * w[i] for i in range(3))
        self.G = mp.sqrt(square)
        a, b, c = order if square > twice * I[order[1]] else order[::-1]
        Ia, Ib, Ic = self.I = I[a], I[b], I[c]
        da, dc = abs(square - twice * Ia), abs(square - twice * Ic)
        self.m = abs(Ib - Ia) * dc / (abs(Ic - Ib) * da)
        self.rate = mp.sqrt(da * abs(Ic - Ib) / (Ia * Ib * Ic))
        self.A = [
            mp.sqrt(Ia * dc / abs(Ic - Ia)),
            mp.sqrt(Ib * dc / abs(Ic - Ib)),
            mp.sqrt(Ic * da / abs(Ic - Ia)),
        ]
        sc = 1 if m[c] > 0 else -1
        sa = sc if (b - a) % 3 == 1 else -sc
        self.axes, self.signs = (a, b, c), (sa, 1, sc)
        self.turn = mp.zeros(3)
        self.turn[0, a], self.turn[1, b], self.turn[2, c] = sa, 1, sc
        start = [sa * m[a], m[b], sc * m[c]]
        self.sense = 1 if Ia < Ic else -1
        self.K, self.n = mp.ellipk(self.m), -Ic * abs(Ib - Ia) / (Ia * abs(Ic - Ib))
        self.period = 4 * self.K / self.rate
        self.u0 = mp.ellipf(mp.atan2(start[1] / self.A[1], start[0] / self.A[0]), self.m)
        self.drift = (
            (1 if twice * Ic > square else -1)
            * dc
            * self.G
            / (Ic * self.A[0] ** 2)
            / (self.sense * self.rate)
        )
        self.first, self.frame0 = self._third(self.u0), self._frame(start)

    def at(self, t):
        u = self.sense * self.rate * t + self.u0
        half, rest = self._reduce(u)
        flip = -1 if int(half) % 2 else 1
        sn, cn, dn = (mp.ellipfun(f, rest, m=self.m) for f in ("sn", "cn", "dn"))
        mv = [flip * self.A[0] * cn, flip * self.A[1] * sn, self.A[2] * dn]
        w = [0, 0, 0]
        for axis, sign, moment, value in zip(self.axes, self.signs, self.I, mv, strict=True):
            w[axis] = sign * value / moment
        psi = self.G * t / self.I[2] + self.drift * (self._third(u) - self.first)
        c, s = mp.cos(psi), mp.sin(psi)
        about = mp.matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        return w, self.turn.T * self.frame0.T * about * self._frame(mv) * self.turn

    def _reduce(self, u):
        half = mp.nint(u / (2 * self.K))
        return half, u - 2 * self.K * half

    def _third(self, u):
        half, rest = self._reduce(u)
        sn = mp.ellipfun("sn", rest, m=self.m)
        amplitude = mp.asin(max(min(sn, mp.mpf(1)), mp.mpf(-1)))
        return 2 * half * mp.ellippi(self.n, self.m) + mp.ellippi(self.n, amplitude, self.m)

    def _frame(self, m):
        across = mp.sqrt(m[0] ** 2 + m[1] ** 2)
        G = self.G
        return mp.matrix(
            [
                [m[0] * m[2] / (G * across), m[1] * m[2] / (G * across), -across / G],
                [-m[1] / across, m[0] / across, 0],
                [m[0] / G, m[1] / G, m[2] / G],
            ]
        )


def main(per_family: int, target: Path) -> None:
    """Write the fixtures; each family from its own seed."""
    columns: dict[str, list] = {name: [] for name in ("family", "I", "w0", "t", "w", "R")}
    for number, family in enumerate(FAMILIES):
        rng = np.random.default_rng([2026, number])
        for _ in range(per_family):
            moments, spin = draw(family, rng)
            phases = rng.choice([-1, 1], TIMES) * np.array([rng.uniform(0, 3), 10.0 ** rng.uniform(1, 8)])
            t, w, R = truth(moments, spin, phases)
            for name, value in zip(columns, (number, moments, spin, t, w, R), strict=True):
                columns[name].append(value)
        print(family, len(columns["I"]), flush=True)
    np.savez_compressed(target, **{name: np.array(values) for name, values in columns.items()})


if __name__ == "__main__":
    main(
        int(sys.argv[1]) if len(sys.argv) > 1 else PER_FAMILY,
        Path(sys.argv[2]) if len(sys.argv) > 2 else HERE / "truth.npz",
    )
