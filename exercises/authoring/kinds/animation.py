"""Questions about an animation of points that follow given trajectories."""

import functools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from exercises.authoring.assignments.assignment import ArraySpec, Scene
from exercises.authoring.kinds import kind
from exercises.authoring.kinds.motion_behind_animation import own_motion
from exercises.authoring.questions.author_arguments import Given, Itself, Limit, Positive, tolerance_data
from exercises.authoring.questions.question import Question
from exercises.authoring.solutions import NotebookSolution
from polhode.animation.animation_recording import FRAME_CAP, HEIGHT, POINTS, STILLS, WIDTH
from polhode.animation.artist_points import MOST_AXES
from polhode.judging.outcome import Tolerance
from polhode.kinds import student_calls
from polhode.kinds.animation.animation_of_cell import MOST_OWN
from polhode.kinds.animation.body import AGREE

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
OWN = {
    "own_R": ArraySpec((MOST_OWN, 3, 3), up_to=True),
    "own_t": ArraySpec((MOST_OWN, 1), up_to=True),
    "own_I": ArraySpec((8, 3), up_to=True),
}
"""The numbers behind an animation that a cell shows (polhode.kinds.animation.animation_of_cell)."""
RECORDING_S, BUDGET_S = 12.0, 15.0


@dataclass(frozen=True, eq=False)
class Animated(Question):
    """A question whose answer is the recording of an animation, and whose exact answer is the trajectories it
    is given.
    """

    @functools.cached_property
    def document(self) -> dict[str, Any]:
        """The question as data, with the scene's own name."""
        found, own = super().document, self.data["scene"]
        return found | ({"scenes": {"public": own, "hidden": None}} if own else {})

    @property
    def asked(self) -> dict[str, Any]:
        """The question as data."""
        return self.document

    def exact(self, rows: Mapping[str, Any], part: Any = None) -> dict[str, Any]:
        """Return the times and trajectories of the first row, and the drawn values as ``at_NAME``."""
        given = student_calls.arguments(self.document, next(student_calls.each_row(rows), {}))
        names = (self.data["time"], *self.data["follow"], *_of_body(self.data["body"]))
        wanted = {name: np.asarray(given[name], dtype=float) for name in names}
        return wanted | {f"at_{name}": np.asarray(rows[name]) for name in self.drawn}

    def scene(self, name: str, rows: int, part: Any = None) -> Scene:
        """Return the scene; that of a body is judged by the motion behind an animation that a cell shows."""
        own, body = self.data["scene"], self.data["body"]
        made = super().scene(name, rows, part)
        if not body:
            return made
        moments, time = self.data["moments"], self.data["time"]

        def replaced(inputs: Any, seen: Any) -> Any:
            return own_motion(seen, moments, {"t": time, **body})

        def exact(inputs: Any) -> Any:
            return self.exact({}) | dict(inputs)

        return replace(made, name=own or made.name, replaced=replaced if body["L"] else None, truth=exact)

    def _specs(self, rows: int, part: Any = None) -> Any:
        return RECORDING | OWN if self.data["body"] else RECORDING


def _of_body(body: Mapping[str, Any] | None) -> list[str]:
    """Return the arguments that are the motion of a body."""
    return [body[key] for key in ("R", "L", "half") if body[key]] if body else []


@kind(rows=None, budget_s=BUDGET_S, uses=False)
def animation(
    solution: NotebookSolution,
    inputs: Given,
    follow: Sequence[str],
    agree: Limit,
    *,
    time: str = "t",
    budget_s: Positive = BUDGET_S,
) -> Question:
    """Return the question to draw an animation with ``solution``, which returns or shows it, from the
    arguments ``inputs``.

    ``follow`` names the arguments that are trajectories, arrays (n, 2) or (n, 3), at the times (n,) of the
    argument ``time``. Each must be followed by something drawn, evenly from its start to its end. The
    ``limit`` of ``agree`` is the largest deviation, relative to the trajectory's extent. A hidden scene
    exists if an argument is drawn.
    """
    made = Animated(
        kind="animation",
        solution=solution,
        inputs=inputs,
        values={},
        truth=Itself("the trajectories are given"),
        data={
            "follow": list(follow),
            "time": time,
            "agree": tolerance_data(agree),
            "seconds": RECORDING_S * budget_s / BUDGET_S,
            "body": None,
            "title": None,
            "sheet": None,
            "scene": None,
        },
        rows=(1, 1),
        errors=lambda: _errors(made),
    )
    return made


@kind(rows=None, budget_s=BUDGET_S, uses=False)
def body_animation(
    solution: NotebookSolution,
    inputs: Given,
    body: Mapping[str, Any],
    *,
    time: str = "t",
    moments: Sequence[float] = (),
    title: str | None = None,
    sheet: str | None = None,
    scene: str | None = None,
    budget_s: Positive = BUDGET_S,
) -> Question:
    """Return the question to draw a turning body with ``solution`` from the arguments ``inputs``, in any
    style.

    ``body`` names the arguments R, attitudes (n, 3, 3) from body axes to space at the times ``time``, and L,
    the angular momentum in space, or half, the half edges of a box; ``axis`` (0, 1, 2) is the body axis to
    draw, None for any points of the body. An animation of a symmetric top that a cell shows is accepted in
    place of the function: its moments are among the notebook's numbers, or are ``moments``. ``title`` is that
    of the contact sheet.
    """
    return Animated(
        kind="animation",
        solution=solution,
        inputs=inputs,
        values={},
        truth=Itself("the motion is given"),
        data={
            "follow": [],
            "time": time,
            "agree": tolerance_data(Tolerance(limit=0.03, reason=AGREE)),
            "seconds": RECORDING_S * budget_s / BUDGET_S,
            "body": {"R": None, "L": None, "half": None, "axis": None} | dict(body),
            "title": title,
            "sheet": sheet,
            "scene": scene,
            "moments": list(moments),
        },
        rows=(1, 0),
    )


def _errors(question: Question) -> Iterator[str]:
    """Yield the errors of the trajectories."""
    wanted = [question.data["time"], *question.data["follow"]]
    if absent := [name for name in wanted if name not in question.inputs]:
        yield f"{question.function} has no input {', '.join(absent)}"
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
