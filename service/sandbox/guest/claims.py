"""The calls of the validation words in a notebook's cells, sent to the host as data while the cells run."""

import importlib
import sys
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType, ModuleType
from typing import Any

import numpy as np

from polhode.judging import validate
from polhode.judging.claims import Claim

from .seal import private_modules
from .wire import Writer

MOST_CLAIMS = 100  # of the cells of one submission
MOST_AT_PLACE = 1000  # of one call in a published cell
MOST_REPORTED = 10_000  # of all published cells
MOST_CUT = 1000  # calls of published cells of which not every claim is sent
MOST_NUMBERS = 1 << 16  # of one claim: 512 KiB
MOST_IN_ALL = 1 << 20  # numbers of all claims: 8 MiB
MOST_AXES = 8
course = list[str]()  # folders with the course's own packages
PRIVATE = ("polhode.judging.judge", "polhode.judging.claims", "polhode.judging.validate")
_getframe = sys._getframe  # a submission can replace it


class Recorder:
    """Recorder of the claims in each ``cell``. A claim that is too large is kept without its arrays, with the
    reason.

    Claims are sent between cells, because a cell's time may run out in the middle of a frame.
    """

    def __init__(self) -> None:
        self.cell, self._claims = "", 0
        self._numbers = {False: 0, True: 0}  # of the submission's own cells and of the published ones
        self._reported, self._all_reported = Counter[tuple[str, int, int]](), 0
        self._cut = set[tuple[str, int, int]]()
        self.places = False  # whether claims are sent with their place in the cell's source
        with private_modules(PRIVATE) as copies:
            self.validate: Any = copies["polhode.judging.validate"]
        self._names = dict[str, ModuleType]()  # of the words, and the package of each
        self._unsent: list[tuple[dict[str, Any], Mapping[str, np.ndarray]]] = []

    @contextmanager
    def recording(self) -> Iterator[None]:
        """Record the claims made inside the ``with`` block."""
        for module in (validate, self.validate):
            module.watchers.append(self._record)
        try:
            yield
        finally:
            for module in (validate, self.validate):
                module.watchers.clear()

    @contextmanager
    def in_place(self, student: dict[str, Any]) -> Iterator[None]:
        """Let a published cell that runs inside the ``with`` block find the private copy of the words, by the
        names under which the course's packages have them.
        """
        self._names |= {name: sys.modules[name.rpartition(".")[0]] for name in _names_of(validate)}
        theirs = student.get("validate", validate)
        student["validate"] = self.validate
        self._put(self.validate)
        try:
            yield
        finally:
            self._names |= {name: sys.modules[name.rpartition(".")[0]] for name in _names_of(self.validate)}
            self._put(validate)
            if student.get("validate") is self.validate:
                student["validate"] = theirs

    def find_names(self) -> None:
        """Find the words in the course's packages before a submission can replace them there."""
        for place in (place for folder in course for place in sorted(Path(folder).glob("*/validate.py"))):
            with suppress(Exception):  # the cell that imports it says what is wrong
                importlib.import_module(f"{place.parent.name}.validate")
        self._names |= {name: sys.modules[name.rpartition(".")[0]] for name in _names_of(validate)}

    def _put(self, words: ModuleType) -> None:
        for name, package in self._names.items():
            parent, _, child = name.rpartition(".")
            sys.modules |= {parent: package, name: words}
            setattr(package, child, words)

    @property
    def left_out(self) -> int:
        """The number of claims beyond the limit."""
        return max(0, self._claims - MOST_CLAIMS)

    def _record(self, claim: Claim) -> None:
        place = _place(self.cell) if self.places else None
        if place is None:
            self._claims += 1
            kept, beyond = self._claims <= MOST_CLAIMS, ""
        else:
            kept, beyond = self._kept((self.cell, place[0], place[1]))
        if not kept:
            return
        size = sum(array.nbytes // 8 for array in claim.arrays.values())
        left_out = beyond or self._too_large(claim, size)
        arrays = {} if left_out or claim.unfit else claim.arrays
        self._numbers[self.places] += size if arrays else 0
        header: dict[str, Any] = {name: getattr(claim, name) for name in ("kind", "label", "detail", "unfit")}
        header |= {
            "cell": self.cell,
            "left_out": left_out,
            "numbers": {k: float(v) for k, v in claim.numbers.items()},
        }
        header |= {} if place is None else {"place": place}
        self._unsent.append((header, arrays))

    def _kept(self, place: tuple[str, int, int]) -> tuple[bool, str]:
        """Return whether a claim made there is sent, and why without its arrays: the first one beyond a limit
        is sent.
        """
        if self._all_reported < MOST_REPORTED and self._reported[place] < MOST_AT_PLACE:
            self._reported[place] += 1
            self._all_reported += 1
            return True, ""
        first = place not in self._cut and len(self._cut) < MOST_CUT
        self._cut |= {place} if first else set()
        return first, f"more than {MOST_AT_PLACE} checks of one line, or {MOST_REPORTED} of the notebook"

    def send(self, write: Writer) -> None:
        """Send the claims recorded since the last call."""
        unsent, self._unsent = self._unsent, []
        for header, arrays in unsent:
            write.claim(header, arrays)

    def leave_out(self, reason: str) -> None:
        """Send the claims recorded since the last call without their arrays, for this reason."""
        self._unsent = [(header | {"left_out": reason}, {}) for header, _ in self._unsent]

    def _too_large(self, claim: Claim, size: int) -> str:
        if any(array.ndim > MOST_AXES for array in claim.arrays.values()):
            return f"an array has more than {MOST_AXES} axes"
        if size > MOST_NUMBERS:
            return f"{size} numbers; one check may have at most {MOST_NUMBERS}"
        if self._numbers[self.places] + size > MOST_IN_ALL:
            return f"all checks together have more than {MOST_IN_ALL} numbers"
        return ""


def _names_of(module: ModuleType) -> list[str]:
    """Return the names by which a module can be imported."""
    return [name for name, found in sys.modules.copy().items() if found is module and "." in name]


def _place(cell: str) -> list[int]:
    """Return line and column, of the cell that runs, of the call that is in progress; [0, 0] if it does not
    run.
    """
    frame: FrameType | None = _getframe()
    while frame is not None and frame.f_code.co_filename != cell:
        frame = frame.f_back
    if frame is None:
        return [0, 0]
    line, _, column, _ = list(frame.f_code.co_positions())[frame.f_lasti // 2]
    return [line or 0, column or 0]
