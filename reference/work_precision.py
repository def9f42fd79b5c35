"""Work-precision data: every method at every setting on every scene, with its error over the run, calls and
CPU time.

An error is the maximum over the time grid against the exact solution, because the error at one final time may
be small by chance. CPU time is given relative to DOP853 at rtol 1e-11, measured right after it, because
absolute times on a shared machine vary.
"""

import statistics
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict, dataclass
from functools import partial

import numpy as np

from reference.errors import errors, exact_run
from reference.exact import Exact
from reference.inertia import box_moments
from reference.methods import HEAVY, METHODS, Method, Scene

_BOOK: tuple[float, float, float] = tuple(float(x) for x in box_moments(1.0, 2.0, 1.4, 0.4))  # type: ignore[assignment]
_NEAR = (1e-8 * 6, 6.0, 0.7e-8 * 6)
_ROD = 1e-4

SCENES = (
    Scene("exercise 2", (1.0, 0.6, 0.8), (2.0, 3.0, 4.0), 20.0),
    Scene("exercise 5, about ê₁", (6.0, 0.12, 0.12), _BOOK, 2.5),
    Scene("exercise 5, about ê₂", (0.12, 6.0, 0.12), _BOOK, 2.5),
    Scene("exercise 5, about ê₃", (0.12, 0.12, 6.0), _BOOK, 2.5),
    Scene("exercise 6", (0.2, 0.3, 3.0), (1.0, 1.0, 1.6), 8.0),
    Scene("separatrix, nudge 1e-8", _NEAR, _BOOK, 2.1 * Exact(_NEAR, _BOOK).period),
    Scene("rod, I₁ = 1e-4", (1 / _ROD, 0.3, 0.2), (_ROD, 1.0, 1.0 + _ROD / 2), 0.02),
    Scene("heavy top", (0.0, 0.6, 14.0), (1.0, 1.0, 0.6), 4.0, mgl=10.0, tilt=0.6),
    Scene(
        "heavy top, 1e-3 rad from the vertical", (0.0, 0.6, 14.0), (1.0, 1.0, 0.6), 4.0, mgl=10.0, tilt=1e-3
    ),
)
YARDSTICK, YARDSTICK_RTOL = "DOP853", 1e-11
REPEATS = 3
LONG_S = 0.5  # a run longer than this is timed once
SHORTEST_S = 2e-3  # a run shorter than this is timed several at a time


@dataclass(frozen=True)
class Point:
    """One method at one setting on one scene.

    ``error_w`` is relative to |ω₀|; a run that diverges has infinite errors; ``ratio`` is CPU time over the
    yardstick's, measured in turn.
    """

    scene: str
    method: str
    line: str
    setting: float
    error_w: float
    error_R: float
    energy: float
    momentum: float
    orthonormality: float
    calls: int
    seconds: float
    ratio: float


def measure(
    scenes: Iterable[Scene] = SCENES, methods: Iterable[Method] | None = None, repeats: int = REPEATS
) -> Iterator[Point]:
    """Yield all points, scene by scene; without ``methods`` those of the scene's problem, torque-free body or
    heavy top.
    """
    for scene in scenes:
        exact, known = exact_run(scene), HEAVY if scene.mgl else METHODS
        yardstick = next(m for m in known if m.name == YARDSTICK)
        for method in known if methods is None else methods:
            for setting in method.settings:
                with np.errstate(all="ignore"):
                    run = method.run(scene, setting)  # compiles what is not compiled yet
                    cost = _paired(
                        partial(method.run, scene, setting),
                        partial(yardstick.run, scene, YARDSTICK_RTOL),
                        repeats,
                    )
                yield Point(
                    scene.name,
                    method.name,
                    method.line,
                    setting,
                    *errors(scene, run, exact),
                    run.calls,
                    *cost,
                )


def rows(points: Iterable[Point]) -> list[dict[str, str | float | int]]:
    """Return the points as plain rows for CSV and JSON."""
    return [asdict(p) for p in points]


def _paired(one: Callable[[], object], other: Callable[[], object], repeats: int) -> tuple[float, float]:
    """Return the median CPU seconds of ``one``, and the median of its ratio to ``other``, run in turn."""
    once = _seconds(one, 1)
    many = max(1, min(200, round(SHORTEST_S / max(once, 1e-6))))
    pairs = [(_seconds(one, many), _seconds(other, 1)) for _ in range(repeats if once < LONG_S else 1)]
    return statistics.median(a for a, _ in pairs), statistics.median(a / b for a, b in pairs)


def _seconds(run: Callable[[], object], many: int) -> float:
    began = time.process_time()
    for _ in range(many):
        run()
    return (time.process_time() - began) / many
