"""What a peer is: a tool in an environment of its own that grades a submission by a command and leaves its answer in a file."""

import contextlib
import os
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from bench.peers.submissions import Submission


@dataclass(frozen=True)
class Command:
    """One process: its words, where it runs, and the file that gets what it prints (none: the peer's log)."""

    words: Sequence[str | Path]
    folder: Path
    out: Path | None = None


@dataclass(frozen=True)
class Marks:
    """What a tool gave, and the most it could give."""

    points: float
    most: float

    @property
    def full(self) -> bool:
        """Whether it found nothing wrong."""
        return self.points == self.most > 0

    def __str__(self) -> str:
        return f"{self.points:g}/{self.most:g}"


class Unread(Exception):
    """A tool left no answer, or none we understand."""


@contextlib.contextmanager
def reading(tool: str) -> Iterator[None]:
    """Whatever is wrong with an answer that is read in here is Unread."""
    try:
        yield
    except (OSError, ValueError, LookupError, TypeError, AttributeError, StopIteration) as error:
        raise Unread(f"{tool}: {error!r}") from error


@dataclass(frozen=True)
class Place:
    """Where a peer lives."""

    python: Path
    folder: Path
    environment: Mapping[str, str] = field(default_factory=dict)

    def tool(self, name: str) -> Path:
        """A command of its environment."""
        return self.python.with_name(name)


class Peer(ABC):
    """A tool to compare with: its name in the tables, its requirements' name, and how it is made to grade several."""

    name: str
    package: str
    batch: str

    def __init__(self, place: Place) -> None:
        self.place = place

    @abstractmethod
    def prepare(self, submissions: Mapping[str, Submission]) -> Sequence[Command]:
        """Write what is graded and what it is graded with; commands to run before anything is timed."""

    @abstractmethod
    def one(self, name: str) -> Command:
        """Grade one submission as a course would."""

    def many(self, names: Sequence[str]) -> Sequence[Command]:
        """Grade these in the fastest way that the tool itself has (``batch`` tells which); here one after the other."""
        return [self.one(name) for name in names]

    def export(self) -> Sequence[Command]:
        """What has to run before marks are read."""
        return []

    @abstractmethod
    def marks(self, name: str) -> Marks:
        """What it said when it last graded this submission; raises Unread."""


def clean_environment(home: Path, tools: Path) -> dict[str, str]:
    """This process's environment, its commands looked for in ``tools`` first, and without what would reach into a peer's.

    That is: our paths and settings, the user's home, and that bytecode is not to be written.
    """
    kept = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "POLHODE_", "JUPYTER", "MPL", "VIRTUAL_ENV"))}
    return kept | {"HOME": str(home), "PATH": f"{tools}:{os.environ['PATH']}", "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
