"""The result of playing a job: arrays that the host has validated, and scene ends."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from numpy.typing import NDArray

from polhode.judging.claims import Claim, NotebookCheck
from polhode.judging.outcome import Ended, SceneEnd
from polhode.judging.remarks import Notes
from service.sandbox.guest.cells.place import Place

KEPT_OUTPUT = 64 << 10  # bytes of printed output


SENTENCES = {
    Ended.FINISHED: "finished",
    Ended.RAISED: "your code raised an exception",
    Ended.SYNTAX: "your code has a syntax error: correct the marked line",
    Ended.WRONG_ANSWER: "your function returned the wrong kind of value: compare it with the exercise",
    Ended.MISSING: "the function is not defined",
    Ended.TIMED_OUT: "your code did not finish in the time allowed",
    Ended.MEMORY: "your code asked for more memory than is allowed",
    Ended.EXITED: "your code ended the Python process",
    Ended.KILLED: "the Python process crashed",
    Ended.OUTPUT: "your code printed or returned far too much",
    Ended.PROTOCOL: "the process of your code sent an invalid result",
    Ended.NOT_PLAYED: "not played, because an earlier step did not finish",
}

CODES = {Ended.TIMED_OUT: "timeout", Ended.MEMORY: "memory"}  # diagnosis codes that follow from a scene end

# Diagnosis codes that a guest may report; the host determines all others.
GUEST_CODES = frozenset(
    [
        "missing-function",
        "timeout",
        "memory",
        "syntax-error",
        "raises",
        "returns-nothing",
        "wrong-shape",
        "mutates-input",
    ]
    + ["not-finite", "unbounded", "no-animation", "too-many-frames", "signature", "swapped-arguments"]
)


@dataclass
class PlayResult:
    """The result of one play.

    ``loaded`` is True once a child has run all cells. ``defined`` are the requested functions that the
    submission defines, ``missing`` those that it does not because a statement failed. ``left_out`` are the
    statements that ended a child, with how they did. ``arrays`` are the results by scene and name, ``notes``
    what a scene says besides its arrays, ``scene_ends`` those of scenes, ``cells`` those of failed cells,
    ``author_errors`` are exceptions, by scene, that the
    guest attributes to the assignment's code; a submission can forge them. ``claims`` are the notebook's own
    checks; ``claims_left_out`` counts those beyond the limit. ``reported`` are those of the published cells,
    by cell and place. ``cpu_s`` is the CPU time that was used.
    """

    loaded: bool = False
    defined: set[str] = field(default_factory=set)
    missing: set[str] = field(default_factory=set)
    left_out: dict[Place, SceneEnd] = field(default_factory=dict)
    arrays: dict[str, dict[str, NDArray[Any]]] = field(default_factory=dict)
    notes: dict[str, Notes] = field(default_factory=dict)
    scene_ends: dict[str, SceneEnd] = field(default_factory=dict)
    cells: dict[str, SceneEnd] = field(default_factory=dict)
    author_errors: dict[str, str] = field(default_factory=dict)
    claims: list[NotebookCheck] = field(default_factory=list)
    claims_left_out: int = 0
    reported: dict[tuple[str, tuple[int, int]], list[Claim]] = field(default_factory=dict)
    stdout: str = ""
    cpu_s: float = 0.0

    def add(self, other: "PlayResult") -> None:
        """Add the result of another child that ran the same submission."""
        for name in ("defined", "missing", "left_out", "arrays", "notes"):
            getattr(self, name).update(getattr(other, name))
        for name in ("scene_ends", "author_errors"):
            getattr(self, name).update(getattr(other, name))
        self.cells = {**other.cells, **self.cells}  # the first failure of a cell is the cause of others
        if not self.loaded:  # each child runs the cells again; one that did not end them counts for nothing
            self.claims, self.claims_left_out = other.claims, other.claims_left_out
            self.reported, self.stdout = other.reported, other.stdout
        else:
            self.stdout = (self.stdout + other.stdout)[:KEPT_OUTPUT]
        self.loaded |= other.loaded
        self.cpu_s += other.cpu_s

    @property
    def written(self) -> set[str]:
        """The functions that the submission attempts: those it defines, or would without a failure."""
        return self.defined | self.missing

    def noted(self, scene: str | None) -> Notes:
        """Return the notes of ``scene``, empty if there are none."""
        return self.notes.get(scene or "", Notes())

    def finished(self, scene: str) -> bool:
        """Return whether ``scene`` was played to its end."""
        return scene in self.scene_ends and self.scene_ends[scene].ended is Ended.FINISHED


OnScene = Callable[[str], None]
"""A function that is called with the name of each scene that begins."""


def ignore(scene: str) -> None:
    """Do nothing when a scene begins."""


class Cancelled(Exception):
    """The play was cancelled."""


class SystemFault(Exception):
    """The submission could not be graded because polhode or a course author failed. Never a verdict."""


class TooBusy(SystemFault):
    """Other programs used the processors that the submission waited for."""


class NotPrepared(SystemFault):
    """The assignment's Setup or plays.py failed before the submission ran."""
