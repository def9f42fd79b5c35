"""Make top_truth.npz: θ, φ, ψ of heavy symmetric tops over 100 nutations, integrated to sixty digits.

The integration knows neither Euler angles nor elliptic functions: Taylor series of Euler's equations in the
body's axes, of the vertical γ seen from these axes, and of a quaternion. `reference.heavy_top` uses the
cubic's roots and elliptic integrals. Run ``python -m tests.reference.make_top_truth``; it takes some minutes
on one core for a file that does not exist.
"""

import sys
from pathlib import Path

import mpmath as mp
import numpy as np

HERE = Path(__file__).parent
DIGITS, ORDER = 60, 70
NUTATIONS = 100
TOPS = {  # θ, φ, ψ, θ̇, φ̇, ψ̇ at t = 0, I₁, I₃ and mgl
    "nutating": ((0.6, 0.2, -0.4, 0.7, 1.1, 14.0), 1.3, 0.7, 5.0),
    "cuspidal": ((0.9, 0.0, 0.0, 0.0, 0.0, 25.0), 1.0, 0.5, 9.81),
    "looping": ((1.1, 1.0, 2.0, -0.3, -0.8, 20.0), 1.2, 0.8, 6.0),
    "slow spin, below the pivot": ((2.0, 0.0, 0.5, 1.5, 1.0, 2.0), 2.0, 1.5, 8.0),
    "almost steady": ((0.7, 0.1, 0.3, 1e-7, 3.0, 7.0852457), 1.0, 0.6, 10.0),
    "nearly upright": ((1e-3, 0.3, 0.1, 0.0, 500.0, -480.0), 1.0, 1.5, 8.0),
    "near the sleeping top": ((1e-4, 0.0, 0.0, 1e-5, 4.0, 3.9), 1.0, 1.5, 38.0),
    "spherical pendulum": ((1.8, 0.0, 0.0, 0.4, 1.3, 0.2952626), 1.0, 0.9, 3.0),
}
ANY_SPIN_OR_SIZE = {
    "swinging, spin 1e-6": ((1.0, 0.0, 0.0, 0.5, 0.0, 1e-6), 1.0, 0.6, 10.0),
    "from rest, spin 1e-6": ((1.0, 0.0, 0.0, 0.0, 0.0, 1e-6), 1.0, 0.6, 10.0),
    "over the top, spin 1e-6": ((1.0, 0.2, 0.0, 6.0, 0.0, 1e-6), 1.3, 0.7, 5.0),
    "swinging, spin 1e-3": ((2.0, 0.0, 0.5, 0.3, 1e-4, 1e-3), 1.0, 1.5, 8.0),
    "spin 1e4": ((0.6, 0.2, -0.4, 0.7, 1.1, 1e4), 1.3, 0.7, 5.0),
    "moments 1e100": ((0.6, 0.2, -0.4, 0.7, 1.1, 14.0), 1.3e100, 0.7e100, 5e100),
    "moments 1e-100": ((1.1, 1.0, 2.0, -0.3, -0.8, 20.0), 1.2e-100, 0.8e-100, 6e-100),
}


def rows(y0, I1, I3, mgl, times):
    """Return θ, φ mod 2π, ψ mod 2π (n, 3) as doubles at the rising ``times`` (n,), from y0 (6,) at t = 0."""
    with mp.workdps(DIGITS + 10):
        theta, phi, psi, nod, swing, spin = (mp.mpf(float(x)) for x in y0)
        I1, I3, mgl = (mp.mpf(float(x)) for x in (I1, I3, mgl))
        s, c = mp.sin(theta), mp.cos(theta)
        w = [nod * mp.cos(psi) + swing * s * mp.sin(psi), swing * s * mp.cos(psi) - nod * mp.sin(psi)]
        w3 = spin + swing * c
        up = [s * mp.sin(psi), s * mp.cos(psi), c]
        half = [mp.cos(theta / 2), mp.sin(theta / 2)]
        plus, minus = (phi + psi) / 2, (phi - psi) / 2
        q = [half[0] * mp.cos(plus), half[1] * mp.cos(minus), half[1] * mp.sin(minus), half[0] * mp.sin(plus)]
        state, t, found = [*w, *up, *q], mp.mpf(0), []
        for until in times:
            until = mp.mpf(float(until))
            while t < until:
                series = taylor(state, w3, (I1 - I3) / I1 * w3, mgl / I1)
                last = max(max(abs(x[-1]), abs(x[-2])) for x in series)
                h = min(until - t, (mp.mpf(10) ** -(DIGITS + 6) / last) ** (mp.mpf(1) / ORDER))
                state = [mp.polyval(x[::-1], h) for x in series]
                t += h
            q0, q1, q2, q3 = state[5:]
            plus, minus = mp.atan2(q3, q0), mp.atan2(q2, q1)
            tilt = 2 * mp.atan2(mp.hypot(q1, q2), mp.hypot(q0, q3))
            found.append(
                [float(x) for x in (tilt, mp.fmod(plus + minus, 2 * mp.pi), mp.fmod(plus - minus, 2 * mp.pi))]
            )
    return np.array(found)


def taylor(state, w3, k, g):
    """Return the coefficients (9, ORDER + 1) of ω₁, ω₂, γ and the quaternion; ω₃ is constant."""
    w1, w2, x, y, z, a, b, c, d = series = [[value] for value in state]
    for n in range(ORDER):

        def product(f, g, n=n):
            return mp.fdot(f[: n + 1], g[n::-1])

        rates = (
            k * w2[n] + g * y[n],
            -k * w1[n] - g * x[n],
            y[n] * w3 - product(z, w2),
            product(z, w1) - x[n] * w3,
            product(x, w2) - product(y, w1),
            -(product(b, w1) + product(c, w2) + d[n] * w3) / 2,
            (product(a, w1) + c[n] * w3 - product(d, w2)) / 2,
            (product(a, w2) + product(d, w1) - b[n] * w3) / 2,
            (a[n] * w3 + product(b, w2) - product(c, w1)) / 2,
        )
        for one, rate in zip(series, rates, strict=True):
            one.append(rate / (n + 1))
    return series


def main(target: Path) -> None:
    """Write the fixtures, with times over 100 nutations of each top, or 10 of those with any spin or size.
    Tops that ``target`` has are kept.
    """
    from reference.heavy_top import HeavyTop

    columns: dict[str, list] = {name: [] for name in ("name", "y0", "I1", "I3", "mgl", "t", "angles")}
    kept = np.load(target) if target.exists() else {"name": []}
    for number, (name, top) in enumerate((TOPS | ANY_SPIN_OR_SIZE).items()):
        if name in kept["name"]:
            row = list(kept["name"]).index(name)
            for column, values in columns.items():
                values.append(kept[column][row])
            continue
        most = NUTATIONS if name in TOPS else NUTATIONS / 10
        shares = np.sort(np.random.default_rng([2026, number]).uniform(0, 1, 24) * np.logspace(-3, 0, 24))
        t = HeavyTop(*top).period * most * np.append(shares, 1.0)
        for column, value in zip(columns.values(), (name, *top, t, rows(*top, t)), strict=True):
            column.append(value)
        np.savez_compressed(target, **{column: np.array(values) for column, values in columns.items()})
        print(name, flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else HERE / "top_truth.npz")
