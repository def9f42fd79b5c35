"""Questions about an animation of points that follow given trajectories."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from exercises.authoring.assignments.assignment import ArraySpec
from exercises.authoring.kinds import kind
from exercises.authoring.questions.declared import Ask, Itself, Limit, Positive, tolerance_data
from exercises.authoring.questions.question import Question
from polhode.animation.animation_recording import FRAME_CAP, HEIGHT, POINTS, STILLS, WIDTH
from polhode.animation.artists import MOST_AXES
from polhode.kinds import asking

RECORDING = {
    "frames": ArraySpec((STILLS, HEIGHT, WIDTH, 3), "uint8", up_to=True),
    "tracks": ArraySpec((FRAME_CAP, POINTS, 3), up_to=True),
    "owners": ArraySpec((POINTS, 3), up_to=True),
    "labels": ArraySpec((MOST_AXES, 3), up_to=True),
    "at": ArraySpec((FRAME_CAP, 3), up_to=True),
    "visible": ArraySpec((2,)),
    "cost": ArraySpec((6,)),
}
"""What a scene with an animation returns (polhode.animation.animation_recording)."""
RECORDING_S, BUDGET_S = 12.0, 15.0


@dataclass(frozen=True, eq=False)
class Animated(Question):
    """A question whose answer is the recording of an animation, and whose exact answer is the trajectories it
    is given.
    """

    @property
    def asked(self) -> dict[str, Any]:
        """The question as data."""
        return self.document

    def exact(self, rows: Mapping[str, Any], part: Any = None) -> dict[str, Any]:
        """Return the times and trajectories of the first row, and the drawn values as ``at_NAME``."""
        given = asking.arguments(self.document, next(asking.each_row(rows), {}))
        wanted = {
            name: np.asarray(given[name], dtype=float) for name in (self.data["time"], *self.data["follow"])
        }
        return wanted | {f"at_{name}": np.asarray(rows[name]) for name in self.drawn}

    def _specs(self, rows: int, part: Any = None) -> Any:
        return RECORDING


@kind(rows=None, budget_s=BUDGET_S, uses=False)
def animation(
    solution: Callable[..., Any],
    ask: Ask,
    follow: Sequence[str],
    agree: Limit,
    *,
    time: str = "t",
    budget_s: Positive = BUDGET_S,
) -> Question:
    """Return the question to draw an animation with ``solution``, which returns or shows it, from the
    arguments ``ask``.

    ``follow`` names the arguments that are trajectories, arrays (n, 2) or (n, 3), at the times (n,) of the
    argument ``time``. Each must be followed by something drawn, evenly from its start to its end. The
    ``limit`` of ``agree`` is the largest deviation, relative to the trajectory's extent. A hidden scene
    exists if an argument is drawn.
    """
    made = Animated(
        kind="animation",
        solution=solution,
        ask=ask,
        values={},
        truth=Itself("the trajectories are given"),
        data={
            "follow": list(follow),
            "time": time,
            "agree": tolerance_data(agree),
            "seconds": RECORDING_S * budget_s / BUDGET_S,
        },
        rows=(1, 1),
        errors=lambda: _errors(made),
    )
    return made


def _errors(question: Question) -> Iterator[str]:
    """Yield the errors of the trajectories."""
    wanted = [question.data["time"], *question.data["follow"]]
    if absent := [name for name in wanted if name not in question.ask]:
        yield f"{question.function}: ask has no {', '.join(absent)}"
        return
    if not question.data["follow"]:
        yield f"{question.function}: follow names no trajectory"
    exact = question.exact(question.draw(np.random.default_rng(0), 1))
    if len({exact[name].shape[-1:] for name in question.data["follow"]}) > 1:
        yield f"{question.function}: the trajectories must all have 2 or all have 3 coordinates"
    for name in question.data["follow"]:
        path, n = exact[name], len(exact[question.data["time"]])
        if path.shape not in ((n, 2), (n, 3)):
            yield (
                f"{question.function}: the trajectory {name} has shape {path.shape}; it must be ({n}, 2) or"
                f" ({n}, 3)"
            )
        elif np.ptp(path, axis=0).max() == 0:
            yield f"{question.function}: the trajectory {name} does not move"
