"""The statements of a submission's cells: which of them run, and what those that fail leave undefined."""

import ast
import re
from collections.abc import Callable, Iterator
from time import monotonic
from typing import Any

from polhode.notebook.cell_to_python import DEFINITION
from polhode.notebook.names import names_in

from ..ending import MOST_CAUSE, Cause, describe
from ..time_budget import OutOfTime
from .place import Place

Names = dict[str, Any]
# Definitions and assignments at the top level of a text that Python cannot parse.
BINDING = re.compile(r"^(?:(?:async +)?def +|class +)?([^\W\d]\w*) *(?:[(:]|=(?!=))", re.MULTILINE)
DEFINITIONS = (*DEFINITION, ast.Import, ast.ImportFrom)


class Statements:
    """The statements of all cells in ``names``, which holds what the Setup has bound.

    ``begin`` is called with the place of each statement before it runs. Those in ``left_out``, which ended an
    earlier process, do not run; the cause there says how they ended it. With ``only_definitions``, the cause
    of that, nothing else runs. ``causes`` say why a name is missing. A cell goes on after an error of which
    ``goes_on`` is true.
    """

    def __init__(self, names: Names, begin: Callable[[Place], None], left_out: dict[Place, Cause]) -> None:
        self._names, self._begin, self._left_out = names, begin, left_out
        self._before = dict(names)
        self._spent: dict[Place, float] = {}
        self.only_definitions: Cause | None = None
        self.goes_on: Callable[[BaseException], bool] = lambda error: False
        self.causes: dict[str, Cause] = {}
        self.failures: list[BaseException] = []
        self.exits: list[Place] = []
        self.cell = ""

    def run(self, nodes: list[ast.stmt]) -> Iterator["Attempt"]:
        """Yield each statement of a cell that is to run, as an attempt.

        After one that fails, the others are not run, except for imports and definitions of names that the
        submission has not bound yet: an old draft must not replace a right function. If one fails after
        another was left out, that is the cause: it would have filled a list, for example.
        """
        failure: BaseException | None = None
        left_out: Cause | None = None
        for number, node in enumerate(nodes):
            place = Place(self.cell, node.lineno, node.col_offset)
            if place in self._left_out:
                left_out = left_out or self._left_out[place]
                self._missing(node, self._left_out[place])
                continue
            cause = self.only_definitions or (
                None if failure is None else left_out or self._cause_of(failure)
            )
            if cause is not None and not self._is_new_definition(node):
                self._missing(node, cause)
                continue
            self._begin(place)
            attempt, began = Attempt(node, last=number == len(nodes) - 1), monotonic()
            yield attempt
            self._spent[place] = monotonic() - began
            if isinstance(attempt.error, OutOfTime):
                return
            if isinstance(attempt.error, SystemExit):
                if not attempt.last:
                    self.exits.append(place)
            elif attempt.error is not None:
                self._missing(node, left_out or self._cause_of(attempt.error))
                if not self.goes_on(attempt.error):
                    failure = failure or attempt.error
        if failure is not None:
            self.failures.append(failure)

    def costliest(self) -> Place | None:
        """Return the place of the statement that took most time, None if none has run."""
        return max(self._spent, key=self._spent.__getitem__, default=None)

    def cannot_parse(self, source: str, error: BaseException) -> None:
        """Record the names that a cell with a syntax error would have bound."""
        for name in BINDING.findall(source):
            self._note(name, self._cause_of(error))
        self.failures.append(error)

    def cause(self, error: BaseException) -> Cause | None:
        """Return why the name that a NameError names is missing, or None if no statement was to bind it."""
        name = getattr(error, "name", None) if isinstance(error, NameError) else None
        return self.causes.get(name) if isinstance(name, str) else None

    def _cause_of(self, error: BaseException) -> Cause:
        """Return how a cell ended, or if that follows from an earlier failure, how the first one ended."""
        if (earlier := self.cause(error)) is not None:
            return earlier
        ended = describe(error)
        sentence = f"{self.cell} stopped: {' '.join(str(ended['sentence']).split())}"
        return Cause(sentence[:MOST_CAUSE], ended["code"], ended.get("traceback"))

    def _is_new_definition(self, node: ast.stmt) -> bool:
        return isinstance(node, DEFINITIONS) and not any(map(self._is_bound, _bound(node)))

    def _is_bound(self, name: str) -> bool:
        return name in self._names and self._names[name] is not self._before.get(name, self)

    def _missing(self, node: ast.stmt, cause: Cause) -> None:
        for name in _bound(node):
            self._note(name, cause)

    def _note(self, name: str, cause: Cause) -> None:
        if not self._is_bound(name):
            self.causes.setdefault(name, cause)


class Attempt:
    """One statement that runs, whether it is the ``last`` of its cell, and the error that it raises."""

    def __init__(self, node: ast.stmt, *, last: bool) -> None:
        self.node, self.last = node, last
        self.error: BaseException | None = None


def _bound(node: ast.stmt) -> frozenset[str]:
    return names_in(ast.unparse(node)).bound
