"""The interface of a peer: a tool in its own environment that grades a submission by a command and leaves its
result in a file.
"""

import contextlib
import os
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from bench.peers.submissions import Submission


@dataclass(frozen=True)
class Command:
    """One process: its arguments, its working folder, and the file for its output (None: the peer's log)."""

    words: Sequence[str | Path]
    folder: Path
    out: Path | None = None


@dataclass(frozen=True)
class Marks:
    """The points given by a tool, and the maximum."""

    points: float
    most: float

    @property
    def full(self) -> bool:
        """Whether the tool gave all points."""
        return self.points == self.most > 0

    def __str__(self) -> str:
        return f"{self.points:g}/{self.most:g}"


class NoMarks(Exception):
    """A tool left no result, or an unreadable one."""


@contextlib.contextmanager
def reading(tool: str) -> Iterator[None]:
    """Convert any error while reading a result to NoMarks."""
    try:
        yield
    except (OSError, ValueError, LookupError, TypeError, AttributeError, StopIteration) as error:
        raise NoMarks(f"{tool}: {error!r}") from error


@dataclass(frozen=True)
class Workspace:
    """The interpreter, working folder and environment variables of a peer."""

    python: Path
    folder: Path
    environment: Mapping[str, str] = field(default_factory=dict)

    def tool(self, name: str) -> Path:
        """Return the path of a command in the peer's environment."""
        return self.python.with_name(name)


class Peer(ABC):
    """A tool to compare with.

    ``name`` is its name in the tables, ``package`` selects its requirements file, ``batch`` says how it
    grades several submissions.
    """

    name: str
    package: str
    batch: str

    def __init__(self, workspace: Workspace) -> None:
        self.workspace = workspace

    @abstractmethod
    def prepare(self, submissions: Mapping[str, Submission]) -> Sequence[Command]:
        """Write the submissions and checks. Return the commands to run before anything is timed."""

    @abstractmethod
    def one(self, name: str) -> Command:
        """Return the command that grades one submission as a course would."""

    def many(self, names: Sequence[str]) -> Sequence[Command]:
        """Return the fastest commands that the tool offers for several submissions; by default one after the
        other.
        """
        return [self.one(name) for name in names]

    def export(self) -> Sequence[Command]:
        """Return the commands to run before marks are read."""
        return []

    @abstractmethod
    def marks(self, name: str) -> Marks:
        """Return the marks of the last grading of this submission. Raises NoMarks."""


def clean_environment(home: Path, tools: Path) -> dict[str, str]:
    """Return the environment variables for a peer: with ``tools`` first on the PATH and without variables
    that affect Python, Jupyter, Matplotlib or polhode.
    """
    kept = {
        k: v
        for k, v in os.environ.items()
        if not k.startswith(("PYTHON", "POLHODE_", "JUPYTER", "MPL", "VIRTUAL_ENV"))
    }
    return kept | {
        "HOME": str(home),
        "PATH": f"{tools}:{os.environ['PATH']}",
        "OMP_NUM_THREADS": "1",
        "OPENBLAS_NUM_THREADS": "1",
    }
