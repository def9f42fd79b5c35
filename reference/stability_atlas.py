"""The stability atlas: where methods fail, with numbers. Each entry measures one failure and states its
threshold.

The body and spin are exercise 2's unless an entry says otherwise; ``h`` is a step in s; a period of ω is 18.2
s.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise

import numpy as np

from reference.errors import errors, exact_run
from reference.exact import Exact
from reference.inertia import box_moments
from reference.methods import HEAVY, METHODS, Run, Scene, heavy
from reference.methods.adaptive import euler_angles
from reference.observables import transverse_growth
from reference.stability import steady_spin_growth_rate

Row = Mapping[str, float | str]
W0, I = (1.0, 0.6, 0.8), (2.0, 3.0, 4.0)
BOOK: tuple[float, float, float] = tuple(float(x) for x in box_moments(1.0, 2.0, 1.4, 0.4))  # type: ignore[assignment]
H = 0.1
BY_NAME = {m.name: m for m in METHODS}
HEAVY_BY_NAME = {m.name: m for m in HEAVY}


@dataclass(frozen=True)
class Entry:
    """One failure: the claim, the measurement, and whether the numbers support the claim."""

    name: str
    claim: str
    measure: Callable[[], list[Row]]
    holds: Callable[[list[Row]], bool]


def long_runs(methods: tuple[str, ...], periods: tuple[int, ...] = (10, 100, 1000)) -> list[Row]:
    """Measure errors after many periods at the step H."""
    period = Exact(W0, I).period
    found: list[Row] = []
    for name in methods:
        for count in periods:
            scene = Scene("long", W0, I, count * period, intervals=10 * count)
            run = BY_NAME[name].run(scene, round(period / 10 / H))
            found.append({**_errors(scene, run), "method": name, "periods": float(count)})
    return found


def separatrix(nudges: tuple[float, ...] = (1e-2, 1e-4, 1e-6, 1e-8)) -> list[Row]:
    """Measure errors over two passages of the book, nudged off its intermediate axis, for each method at its
    best.
    """
    found: list[Row] = []
    for nudge in nudges:
        w0 = (6 * nudge, 6.0, 0.7 * 6 * nudge)
        scene = Scene("nudge", w0, BOOK, 2.1 * Exact(w0, BOOK).period, intervals=400)
        for name, setting in (("DOP853", 1e-9), ("DOP853", 1e-13), ("LSODA", 1e-13)):
            found.append(
                {
                    **_errors(scene, BY_NAME[name].run(scene, setting)),
                    "method": name,
                    "setting": setting,
                    "nudge": nudge,
                }
            )
    return found


def large_steps(methods: tuple[str, ...] = ("Euler", "RK4", "Gauss 12", "Strang splitting")) -> list[Row]:
    """Measure errors of two hundred steps that turn the body by 0.5, 1, 3 and 5 rad each."""
    found: list[Row] = []
    for angle in (0.5, 1.0, 3.0, 5.0):
        scene = Scene("steps", W0, I, 200 * angle / float(np.linalg.norm(W0)), intervals=200)
        for name in methods:
            with np.errstate(all="ignore"):
                found.append({**_errors(scene, BY_NAME[name].run(scene, 1)), "method": name, "angle": angle})
    return found


def gimbal_lock(tilts: tuple[float, ...] = (1.0, 1e-1, 1e-2, 1e-4, 1e-6)) -> list[Row]:
    """Measure the calls that Euler angles need and those of the matrix form, for a top that starts ever
    nearer to the vertical.
    """
    scene = Scene("top", (0.2, 0.3, 3.0), (1.0, 1.0, 1.6), 8.0, intervals=80)
    base = BY_NAME["DOP853"].run(scene, 1e-11).calls
    found: list[Row] = []
    for tilt in tilts:
        run = euler_angles(scene, 1e-11, tilt)
        found.append(
            {**_errors(scene, run), "tilt": tilt, "calls": float(run.calls), "matrix calls": float(base)}
        )
    return found


def heavy_gimbal_lock(tilts: tuple[float, ...] = (1.0, 1e-1, 1e-2, 1e-4, 1e-6)) -> list[Row]:
    """Measure the same for a heavy top that passes the vertical at a distance ``tilt`` in every nutation."""
    found: list[Row] = []
    for tilt in tilts:
        scene = Scene("heavy top", (0.0, 0.6, 14.0), (1.0, 1.0, 0.6), 4.0, mgl=10.0, tilt=tilt)
        run, matrix = heavy.euler_angles(scene, 1e-11), HEAVY_BY_NAME["DOP853"].run(scene, 1e-11)
        found.append(
            {
                **_errors(scene, run),
                "tilt": tilt,
                "calls": float(run.calls),
                "matrix calls": float(matrix.calls),
            }
        )
    return found


def sleeping_top(
    ratios: tuple[float, ...] = (0.3, 0.6, 0.9, 0.98, 1.02, 1.1, 1.5), nudge: float = 1e-6
) -> list[Row]:
    """Measure the largest tilt over one nutation of a top that starts ``nudge`` rad from the vertical, for
    spins ω₃ of ``ratios`` times the limit 2 (I₁ mgl)^½ / I₃.
    """
    I1, I3, mgl, found = 1.0, 0.6, 10.0, list[Row]()
    for ratio in ratios:
        w3 = ratio * 2 * np.sqrt(I1 * mgl) / I3
        scene = Scene("sleeping", (nudge, 0.0, w3), (I1, I1, I3), 0.0, intervals=400, mgl=mgl, tilt=nudge)
        scene = replace(scene, t_end=scene.top().period)
        tilt = np.arccos(np.minimum(HEAVY_BY_NAME["DOP853"].run(scene, 1e-11).R[:, 2, 2], 1.0))
        found.append(
            {
                "method": "DOP853",
                "spin": ratio,
                "largest tilt": float(tilt.max()),
                "exact tilt": scene.top().turning_points[1],
            }
        )
    return found


def rods(ratios: tuple[float, ...] = (1e-1, 1e-2, 1e-3)) -> list[Row]:
    """Measure DOP853's calls for ever thinner rods over one second: fast rotation, not stiffness, so implicit
    methods do not help.
    """
    found: list[Row] = []
    for ratio in ratios:
        scene = Scene("rod", (1 / ratio, 0.3, 0.2), (ratio, 1.0, 1.0 + ratio / 2), 1.0)
        for name, rtol in (("DOP853", 1e-8), ("Radau", 1e-5)):
            if name == "Radau" and ratio < 1e-2:
                continue
            run = BY_NAME[name].run(scene, rtol)
            found.append({**_errors(scene, run), "method": name, "ratio": ratio, "calls": float(run.calls)})
    return found


def growth_map(resolution: int = 12, spin: float = 1.0, nudge: float = 1e-9) -> list[Row]:
    """Measure σ/Ω of a spin about the intermediate axis over the triangle of moments (I₁ ≤ I₂ ≤ I₃ = 1), and
    predict it.

    The measured value is ln of a nudge's growth over the time in which it should grow a thousandfold.
    """
    found: list[Row] = []
    for i1 in np.linspace(0.05, 0.95, resolution):
        for i2 in np.linspace(0.05, 0.98, resolution):
            if not (i1 + 0.01 < i2 and i1 + i2 > 1.001):
                continue
            body = (float(i1), float(i2), 1.0)
            sigma = steady_spin_growth_rate(body, 1, spin)
            growing = np.array([1.0, 0.0, spin * (i1 - i2) / sigma]) * nudge
            t = np.linspace(0.0, np.log(1e3) / sigma, 2)
            w = Exact(growing + [0.0, spin, 0.0], body).omega(t)
            gained = transverse_growth(w, 1, spin) / transverse_growth(w[:, :1], 1, spin)
            found.append(
                {
                    "I1": body[0],
                    "I2": body[1],
                    "predicted": sigma / spin,
                    "measured": float(np.log(gained) / t[1] / spin),
                }
            )
    return found


def _errors(scene: Scene, run: Run) -> Row:
    found = errors(scene, run, exact_run(scene))
    return {
        "error": found.w,
        "error R": found.R,
        **{k: v for k, v in found._asdict().items() if k not in "wR"},
    }


def _column(rows: list[Row], name: str, **wanted: float | str) -> list[float]:
    return [float(r[name]) for r in rows if all(r.get(k) == v for k, v in wanted.items())]


def _tenfold(values: list[float]) -> bool:
    return all(7 < b / a < 14 for a, b in pairwise(values))


ATLAS = (
    Entry(
        "energy drifts",
        "RK4 loses energy in proportion to time: each tenfold longer run, ten times the drift; splitting 6"
        " does not drift",
        partial(long_runs, ("RK4", "splitting 6")),
        lambda rows: (
            _tenfold(_column(rows, "energy", method="RK4"))
            and max(_column(rows, "energy", method="splitting 6"))
            < 2 * min(_column(rows, "energy", method="splitting 6"))
        ),
    ),
    Entry(
        "orthonormality is lost",
        "a matrix integrated by RK4 stops being a rotation; quaternions keep one to rounding",
        partial(long_runs, ("RK4", "splitting 6")),
        lambda rows: (
            _column(rows, "orthonormality", method="RK4")[-1] > 5e-3
            and max(_column(rows, "orthonormality", method="splitting 6")) < 1e-14
        ),
    ),
    Entry(
        "invariants hold and the phase is wrong",
        "Moser-Veselov 2 conserves energy and momentum to rounding while ω is wrong by its own size",
        partial(long_runs, ("Moser-Veselov 2",), (100,)),
        lambda rows: rows[0]["energy"] < 1e-11 and rows[0]["momentum"] < 1e-11 and rows[0]["error"] > 1,  # type: ignore[operator]
    ),
    Entry(
        "the wrong side of the separatrix",
        "nudged by 1e-8, no double-precision stepper finds the side on which the motion passes, at any"
        " tolerance",
        separatrix,
        lambda rows: (
            min(_column(rows, "error", nudge=1e-8)) > 1
            and max(_column(rows, "error", nudge=1e-2, setting=1e-13)) < 1e-7
        ),
    ),
    Entry(
        "large steps blow up",
        "explicit methods leave the sphere of |L| at steps of a radian or more; Gauss and splitting stay"
        " on it",
        large_steps,
        lambda rows: (
            not max(_column(rows, "momentum", method="Euler", angle=0.5)) < 1e3
            and not max(_column(rows, "momentum", method="RK4", angle=5.0)) < 1e-1
            and max(_column(rows, "momentum", method="Strang splitting")) < 1e-12
        ),
    ),
    Entry(
        "gimbal lock",
        "Euler angles need at least three times the calls of the matrix form, and more the nearer the start"
        " is to the vertical",
        gimbal_lock,
        lambda rows: (
            rows[1]["calls"] > 2.5 * rows[1]["matrix calls"]  # type: ignore[operator]
            and rows[-1]["calls"] > 8 * rows[-1]["matrix calls"]  # type: ignore[operator]
        ),
    ),
    Entry(
        "gimbal lock of the heavy top",
        "a heavy top that passes near the vertical costs Euler angles ever more calls, and R as many as any"
        " other motion",
        heavy_gimbal_lock,
        lambda rows: (
            float(rows[-1]["calls"]) > 5 * float(rows[0]["calls"])
            and max(_column(rows, "matrix calls")) < 1.5 * min(_column(rows, "matrix calls"))
        ),
    ),
    Entry(
        "the sleeping top wakes",
        "below ω₃ = 2 (I₁ mgl)^½ / I₃ a nudge of 1e-6 rad becomes a tilt of 2 arccos(ω₃ / limit); above, it"
        " stays a nudge",
        sleeping_top,
        lambda rows: all(
            (
                abs(float(r["largest tilt"]) / (2 * np.arccos(float(r["spin"]))) - 1) < 1e-3
                if float(r["spin"]) < 1
                else float(r["largest tilt"]) < 1e-5
            )
            for r in rows
        ),
    ),
    Entry(
        "rods cost",
        "each tenfold thinner rod costs DOP853 ten times the calls; the exact solution costs the same"
        " for all",
        rods,
        lambda rows: _tenfold(_column(rows, "calls", method="DOP853")),
    ),
    Entry(
        "growth of steady spin",
        "about the intermediate axis a nudge grows at the predicted rate, over the whole triangle of moments",
        growth_map,
        lambda rows: (
            all(abs(float(r["measured"]) / float(r["predicted"]) - 1) < 1e-3 for r in rows) and len(rows) > 20
        ),
    ),
)
