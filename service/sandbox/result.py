"""What came back through the wall: arrays checked by the host, and how each scene ended."""

from dataclasses import dataclass, field
from typing import Any

from numpy.typing import NDArray

from ecp.claims import NotebookCheck
from ecp.outcome import Ended, SceneEnd

KEPT_OUTPUT = 64 << 10  # bytes of what a submission printed


SENTENCES = {
    Ended.FINISHED: "finished",
    Ended.RAISED: "your code raised an exception",
    Ended.SYNTAX: "your code is not Python",
    Ended.WRONG_ANSWER: "your function returned something else than was asked for",
    Ended.MISSING: "the function is not defined",
    Ended.TIMED_OUT: "your code did not finish in the time allowed",
    Ended.MEMORY: "your code asked for more memory than is allowed",
    Ended.EXITED: "your code ended the Python process",
    Ended.KILLED: "the Python process crashed",
    Ended.OUTPUT: "your code printed or returned far too much",
    Ended.PROTOCOL: "what came back was not a result",
    Ended.NOT_PLAYED: "not played, because an earlier step did not finish",
}


# What a guest may name as the cause of an ending; everything else is found out on the host.
GUEST_CODES = frozenset(
    ["missing-function", "timeout", "memory", "syntax-error", "raises", "returns-nothing", "wrong-shape", "mutates-input"]
    + ["not-finite", "unbounded", "no-animation", "too-many-frames", "signature", "swapped-arguments"]
)


@dataclass
class PlayResult:
    """Everything one play brought back: ``arrays`` by scene and name, the ``scene_ends`` of scenes, those of failed ``cells``, and
    what came of scenes that the host drove (``driven``); the notebook's own
    checks (``claims``), and how many more there were."""

    defined: set[str] = field(default_factory=set)
    arrays: dict[str, dict[str, NDArray[Any]]] = field(default_factory=dict)
    scene_ends: dict[str, SceneEnd] = field(default_factory=dict)
    cells: dict[str, SceneEnd] = field(default_factory=dict)
    driven: dict[str, Any] = field(default_factory=dict)
    claims: list[NotebookCheck] = field(default_factory=list)
    claims_left_out: int = 0
    stdout: str = ""

    def add(self, other: "PlayResult") -> None:
        """Take over what another child of the same submission brought back."""
        self.defined |= other.defined
        self.arrays |= other.arrays
        self.scene_ends |= other.scene_ends
        self.cells |= other.cells
        self.driven |= other.driven
        if not self.claims:  # each child runs the cells again
            self.claims, self.claims_left_out = other.claims, other.claims_left_out
        self.stdout = (self.stdout + other.stdout)[:KEPT_OUTPUT]

    def finished(self, scene: str) -> bool:
        """Whether that scene was played to its end."""
        return scene in self.scene_ends and self.scene_ends[scene].ended is Ended.FINISHED


class Cancelled(Exception):
    """Whoever began to play wants it no more."""


class SystemFault(Exception):
    """Our own failure: the submission could not be graded. Never a verdict."""
