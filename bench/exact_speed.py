"""Speed of the exact motion relative to the notebook's integrate_body: interleaved calls, medians of the
paired ratios.

Also its errors on all of truth.npz, of which the tests use a random part. ``make bench`` runs this.
"""

import statistics
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from exercises.authoring.assignments.catalogue import find
from reference import Exact, box_moments, motion

ROOT = Path(__file__).parents[1]
BOOK = tuple(box_moments(1, 2, 1.4, 0.4))
SCENES = {
    "exercise 2": ((1.0, 0.6, 0.8), (2.0, 3.0, 4.0), 20.0, 2000),
    "exercise 5, about e1": ((6.0, 0.12, 0.12), BOOK, 2.5, 400),
    "exercise 5, about e2": ((0.12, 6.0, 0.12), BOOK, 2.5, 400),
    "exercise 5, about e3": ((0.12, 0.12, 6.0), BOOK, 2.5, 400),
    "exercise 6": ((0.2, 0.3, 3.0), (1.0, 1.0, 1.6), 8.0, 400),
}


def notebook() -> Callable[..., object]:
    """Return integrate_body of the notebook's Setup cell."""
    names: dict[str, Callable[..., object]] = {}
    exec(find("rigid-body").setup, names)
    return names["integrate_body"]


def euler_eqs(t, w, I):
    """Euler's equations as the notebook's solution writes them."""
    I1, I2, I3 = I
    return np.array(
        [(I2 - I3) * w[1] * w[2] / I1, (I3 - I1) * w[2] * w[0] / I2, (I1 - I2) * w[0] * w[1] / I3]
    )


def seconds(run: Callable[[], object], times: int = 1) -> float:
    """Return the CPU time of one call, averaged over ``times`` calls in a row."""
    began = time.process_time_ns()
    for _ in range(times):
        run()
    return (time.process_time_ns() - began) / 1e9 / times


def speed(rounds: int = 21, row: int = 20) -> None:
    """Print the ratios for single calls right after the notebook's, with the caches it leaves, and for calls
    in a row.
    """
    integrate = notebook()
    print(f"{'scene':22} {'model':10} {'notebook':>9} {'single':>16} {'in a row':>16}")
    for name, (w0, I, t_end, n) in SCENES.items():
        t = np.linspace(0, t_end, n)
        slow = lambda w0=w0, I=I, t=t: integrate(euler_eqs, w0, I, t)  # noqa: E731
        quick = lambda w0=w0, I=I, t=t: motion(w0, I, t, need="orientation")  # noqa: E731
        quick()
        rows = [(seconds(slow), seconds(quick), seconds(quick, row)) for _ in range(rounds)]
        times = [statistics.median(r[k] for r in rows) for k in range(3)]
        ratios = [statistics.median(r[0] / r[k] for r in rows) for k in (1, 2)]
        cells = [f"{times[k] * 1e6:7.0f}us {ratios[k - 1]:5.0f}x" for k in (1, 2)]
        print(f"{name:22} {Exact(w0, I).model:10} {times[0] * 1e3:7.1f}ms {cells[0]:>16} {cells[1]:>16}")


def accuracy() -> None:
    """Print the largest errors against the 60-digit truth, for each family of bodies."""
    truth = np.load(ROOT / "tests" / "reference" / "truth.npz")
    names = ("generic", "separatrix", "tennis", "near-symmetric", "rod", "near-steady")
    print(f"\n{'family':16} {'bodies':>6} {'omega':>9} {'R':>9}")
    for family, name in enumerate(names):
        chosen = np.flatnonzero(truth["family"] == family)
        worst = np.zeros(2)
        for i in chosen:
            w, R = Exact(truth["w0"][i], truth["I"][i]).sample(truth["t"][i], orientation=True)
            spin = np.linalg.norm(truth["w0"][i])
            worst = np.maximum(
                worst, [np.abs(w.T - truth["w"][i]).max() / spin, np.abs(R - truth["R"][i]).max()]
            )
        print(f"{name:16} {len(chosen):6} {worst[0]:9.1e} {worst[1]:9.1e}")


if __name__ == "__main__":
    speed()
    accuracy()
