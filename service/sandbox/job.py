"""A job for a guest: code to load and scenes to play. It holds no answers."""

import ast
import base64
import functools
import json
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from exercises.authoring.assignments.assignment import ArraySpec
from polhode.judging.outcome import SceneEnd
from service.sandbox.guest.cells.place import Place
from service.sandbox.guest.wire import APART, BYTES, LENGTH, NUMBERS

LOAD_BUDGET_S = 10.0
MEMORY_MB = 512  # MiB of data
SHORT = 20  # numbers that are sent as digits
# What a Python file has from a notebook.
INTERACTIVE = re.compile(r"\bIPython\b|\bget_ipython\b|\bdisplay\(")
MOST_LEFT_OUT = 3  # statements, each of which has ended a process
RUN_AGAIN = "; this statement was left out, and the others were run again"


@dataclass(frozen=True)
class Cell:
    """One cell of a submission. ``name`` is its file name in tracebacks, ``id`` its id in the notebook, if it
    has one.

    A ``published`` cell is the course's own: its claims are sent with their place in its source.
    """

    name: str
    source: str
    published: bool = False
    id: str = ""


@dataclass(frozen=True)
class FunctionsApart:
    """Functions that a scene's rows pass to the submission and that another process answers and counts:
    ``families`` by name, as in a question (polhode.kinds), and the ``inputs`` along the rows that only they
    use. ``units`` has for each row the numbers that one call may have
    (``polhode.kinds.student_calls.evaluations``).
    """

    families: Mapping[str, Mapping[str, Any]]
    inputs: Mapping[str, Any]
    units: Sequence[int]

    def listed(self, scene: str) -> Iterator[dict[str, Any]]:
        """Yield each function as data, those of the first family first: its name for callers, its expression,
        and the values of its row.
        """
        for name, family in self.families.items():
            for row, unit in enumerate(self.units):
                given = {known: self.inputs[known][row] for known in family["given"]}
                target = APART.format(scene=scene, name=name, row=row)
                yield {
                    "target": target,
                    "text": family["text"],
                    "over": family["over"],
                    "given": given,
                    "unit": unit,
                }

    def most_calls(self, counts: Sequence[int]) -> NDArray[np.float64]:
        """Return for each row the most calls of one of its functions; ``counts`` are in the order of the
        list.
        """
        return np.reshape(counts, (len(self.families), len(self.units))).max(axis=0).astype(float)


@dataclass(frozen=True)
class SceneRequest:
    """A scene with its inputs, and the specifications of the arrays that it ``returns``.

    ``question`` is that of the scene, if it has one (polhode.kinds). With ``source`` the scene runs that
    source, after the setup, in place of the submission. Functions ``apart`` are not made in its process.
    """

    name: str
    play: str
    function: str
    inputs: Mapping[str, Any]
    returns: Mapping[str, ArraySpec]
    budget_s: float
    after: str | None
    needs: tuple[str, ...] = ()
    question: Mapping[str, Any] | None = None
    source: str | None = None
    apart: FunctionsApart | None = None

    @property
    def together(self) -> "SceneRequest":
        """This scene with all functions made in the process that plays it, for code of our own."""
        if self.apart is None:
            return self
        return replace(self, inputs={**self.inputs, **self.apart.inputs}, apart=None)


@dataclass(frozen=True)
class ReferenceFunctions:
    """Functions ``names`` that ``source``, run after the setup, defines, in place of those of the submission
    with the same names.

    The source is right solutions, so another process holds it than the one that runs the submission. With
    ``formed`` several values that they return have the form that the submission's functions give them.
    """

    names: tuple[str, ...]
    source: str
    formed: bool = False


class Line(NamedTuple):
    """A line of a published cell: the tolerances that its text gives, by name, and the function that returns
    the truth to compare with, if it has one.
    """

    numbers: tuple[tuple[str, float], ...]
    truth: Callable[[], NDArray[Any]] | None


@dataclass(frozen=True)
class Job:
    """One submission's cells, the assignment's setup and plays as source text, and the scenes in order.

    ``functions`` are the names asked for; those among them that are ``variables`` need not be callable.
    ``data`` are the files that the code can read, by their names relative to its working folder.
    ``load_budget_s`` is the CPU time in seconds for all cells together, or for each of them if there is a
    published one. Statements ``left_out``, by their places, do not run: each ended an earlier
    process, as their ends say. ``lines`` are those of published cells, by cell and place. The data of its
    process may take ``memory_mb`` MiB.
    """

    setup: str
    plays: str
    cells: tuple[Cell, ...]
    functions: tuple[str, ...]
    scenes: tuple[SceneRequest, ...]
    load_budget_s: float = LOAD_BUDGET_S
    memory_mb: int = MEMORY_MB
    variables: tuple[str, ...] = ()
    data: Mapping[str, Path] = field(default_factory=dict)
    reference: ReferenceFunctions | None = None
    left_out: Mapping[Place, SceneEnd] = field(default_factory=dict)
    lines: Mapping[tuple[str, tuple[int, int]], Line] = field(default_factory=dict)

    @property
    def notebook(self) -> bool:
        """Whether IPython runs the cells: those of a notebook, or a file that is not plain Python."""
        return _is_interactive(self.cells)

    @property
    def has_reference(self) -> bool:
        """Whether another process answers functions that the submission calls."""
        return self.reference is not None or any(scene.apart for scene in self.scenes)

    def without(self, done: set[str]) -> "Job":
        """Return this job without the scenes in ``done``."""
        return replace(self, scenes=tuple(s for s in self.scenes if s.name not in done))

    def without_statements(self, ended: Mapping[Place, SceneEnd]) -> "Job":
        """Return this job without the statements that ended a process."""
        return replace(self, left_out={**self.left_out, **ended})

    def frame(self, place: Place) -> str:
        """Return the line of a traceback that names a statement, with its source."""
        lines = next((cell.source.split("\n") for cell in self.cells if cell.name == place.cell), [])
        source = lines[place.line - 1].strip() if 0 < place.line <= len(lines) else ""
        return f'  File "{place.cell}", line {place.line}, in <module>\n    {source}\n'

    def encode(self) -> bytes:
        """Return the job as the guest reads it: a length and JSON."""
        scenes = [
            {
                "name": s.name,
                "play": s.play,
                "function": s.function,
                "inputs": s.inputs,
                "budget_s": s.budget_s,
                "after": s.after,
                "question": s.question,
                "source": s.source,
                "needs": s.needs,
                "returns": {name: vars(spec) for name, spec in s.returns.items()},
                "apart": None if s.apart is None else [list(s.apart.families), len(s.apart.units)],
            }
            for s in self.scenes
        ]
        published = any(cell.published for cell in self.cells)  # the setup is one of these
        document = {
            "setup": "" if published else self.setup,
            "plays": self.plays,
            "notebook": self.notebook,
            "may_run_again": len(self.left_out) < MOST_LEFT_OUT,
            "left_out": [[place, _cause(end)] for place, end in self.left_out.items()],
            "cells": [[c.name, c.source, c.published] for c in self.cells],
            "functions": self.functions,
            "variables": self.variables,
            "load_budget_s": self.load_budget_s,
            "scenes": scenes,
            "reference": self.reference.names if self.reference else (),
            "formed": self.reference is not None and self.reference.formed,
        }
        return _encoded(document)

    def encode_reference(self) -> bytes:
        """Return the job of the process with the reference functions and those of scenes."""
        names, source = (self.reference.names, self.reference.source) if self.reference else ((), "")
        apart = [one for s in self.scenes if s.apart is not None for one in s.apart.listed(s.name)]
        return _encoded({"setup": self.setup, "source": source, "names": names, "apart": apart})

    def calls(self, counts: Mapping[int, int]) -> dict[str, NDArray[np.float64]]:
        """Return for each scene with functions apart how often those of each row were called, from the calls
        of all of them by their places in ``encode_reference``.
        """
        found, first = {}, 0
        for scene in self.scenes:
            if scene.apart is not None:
                end = first + len(scene.apart.families) * len(scene.apart.units)
                found[scene.name] = scene.apart.most_calls([counts.get(k, 0) for k in range(first, end)])
                first = end
        return found


def _cause(end: SceneEnd) -> tuple[str, str | None, str | None]:
    """Return why the names that a statement was to bind are missing, as the fields of the guest's Cause."""
    return f"{end.scene} stopped: {end.sentence.removesuffix(RUN_AGAIN)}", end.code, end.traceback


@functools.lru_cache(maxsize=64)
def _is_interactive(cells: tuple[Cell, ...]) -> bool:
    if len(cells) != 1 or not cells[0].name.endswith(".py"):
        return True
    try:
        return bool(INTERACTIVE.search(cells[0].source)) or not ast.parse(cells[0].source)
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        return True


def _encoded(document: Any) -> bytes:
    text = json.dumps(document, default=_listed).encode()
    return LENGTH.pack(len(text)) + text


def _listed(value: Any) -> Any:
    if isinstance(value, bytes):
        return {BYTES: base64.b64encode(value).decode()}
    if isinstance(value, np.ndarray) and value.dtype == np.float64 and value.size > SHORT:
        return {NUMBERS: value.tobytes(), "shape": value.shape}  # a tenth of the time of their digits
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, Mapping):
        return dict(value)
    raise TypeError(f"{type(value).__name__} is not an input of a scene")
