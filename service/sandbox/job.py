"""The question that crosses the wall: code to load and scenes to play, never an answer."""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from exercises.assignment import ArraySpec, RightHandSide
from service.sandbox.guest.wire import LENGTH

LOAD_BUDGET_S = 10.0


@dataclass(frozen=True)
class Cell:
    """A piece of the submission under the name a traceback shows."""

    name: str
    source: str


@dataclass(frozen=True)
class SceneRequest:
    """A scene with its inputs drawn, and the blanks that may come back for it.

    With ``drive`` there is no play: the host calls the function as often as it likes, and keeps what ``drive(ask)`` returns.
    """

    name: str
    play: str
    function: str
    inputs: Mapping[str, Any]
    returns: Mapping[str, ArraySpec]
    budget_s: float
    after: str | None
    drive: Callable[[RightHandSide], Any] | None = None


@dataclass(frozen=True)
class Job:
    """One submission's cells, the assignment's setup and plays as source text, and the scenes in order.

    ``load_budget_s`` is the time for all cells together, before the first scene.
    """

    setup: str
    plays: str
    cells: tuple[Cell, ...]
    functions: tuple[str, ...]
    scenes: tuple[SceneRequest, ...]
    load_budget_s: float = LOAD_BUDGET_S

    def without(self, done: set[str]) -> "Job":
        """The same job with only the scenes that are not in ``done``."""
        return replace(self, scenes=tuple(s for s in self.scenes if s.name not in done))

    def encode(self) -> bytes:
        """The job as the guest reads it: a length and JSON. What may come back (``returns``) is the host's business and stays."""
        scenes = [
            {"name": s.name, "play": s.play, "function": s.function, "inputs": s.inputs, "budget_s": s.budget_s, "after": s.after}
            | {"asked": s.drive is not None}
            for s in self.scenes
        ]
        document = {
            "setup": self.setup,
            "plays": self.plays,
            "cells": [[c.name, c.source] for c in self.cells],
            "functions": self.functions,
            "load_budget_s": self.load_budget_s,
            "scenes": scenes,
        }
        text = json.dumps(document, default=_listed, allow_nan=False).encode()
        return LENGTH.pack(len(text)) + text


def _listed(value: Any) -> Any:
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} is not an input of a scene")
