"""Run the cells of a submission: those of a notebook by IPython, those of a Python file statement by
statement.
"""

import ast
import linecache
import os
import resource
import sys
import types
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from time import process_time
from typing import Any

from polhode.animation import animate
from polhode.judging.return_value import is_written

from .. import deferred_libraries
from ..confinement.scratch import end_if_full
from ..ending import Cause, ending
from ..time_budget import Budget, OutOfTime, limited
from ..wire import Writer
from .claim_recorder import Recorder
from .jupytext_cells import is_python, pieces
from .place import Place
from .shell_commands import run_command
from .statements import Attempt, Statements
from .unchanged_modules import Given

Names = dict[str, Any]
LEFT_OUT_EXIT = "sys.exit() was left out, and the code after it was run"
GIVEN_MEMORY = (
    "this given cell asked for more memory than is left: free what your cells keep, or tell your course,"
    " which can raise memory_mb of the assignment"
)
DEFINITIONS_S = 1.0  # for the definitions that follow when the time of the cells is spent for good
ONLY_DEFINITIONS = "; of the statements after it, only definitions were run"


class Stopped(Exception):
    """The time of the cells is spent. The host starts another process without the costliest statement."""


class Cells:
    """The cells of a job, run in the namespace ``module`` after its Setup. ``shows`` is the source of the
    last cell that showed an animation, ``names_shown`` what the module's names were then: later cells may
    give them other values.

    ``costs`` are the seconds of CPU time of each cell and the most MiB of memory up to its end, if a cell is
    published. Names in ``fixed`` keep their values, whatever the cells assign to them; that is kept in
    ``replaced``.
    """

    def __init__(
        self, job: dict[str, Any], module: types.ModuleType, write: Writer, fixed: Names, replaced: Names
    ) -> None:
        self._job, self._names, self._write = job, module.__dict__, write
        self.costs = list[tuple[str, float, float]]()
        self._fixed, self._replaced = fixed, replaced
        left_out = {Place(*place): Cause(*cause) for place, cause in job["left_out"]}
        self.statements = Statements(self._names, self._begin, left_out)
        self._budget = Budget(job["load_budget_s"])
        self._run_piece = self._in_shell(module) if job["notebook"] else self._as_script
        first = job["cells"][0][0] if job["cells"] else ""
        sys.argv = [first]
        if first.endswith(".py"):  # a notebook has no __file__
            self._names["__file__"] = first
        os.system = run_command
        self.shows, self.names_shown, self._shown = "", Names(), list[Any]()

    def run(self, recorder: Recorder) -> None:
        """Run all cells in order and report those that fail. A failure does not stop the next cell.

        Their time is that of all of them together, or of each if one is published. Raises Stopped if it is
        spent and the host may start another process; else only definitions run from then on.
        """
        self._names |= self._fixed
        sources = [source for _, source, published in self._job["cells"] if published]
        several = bool(sources)
        self._given = Given(sources, self._job["functions"], recorder) if sources else None
        for name, source, published in self._job["cells"]:
            self._budget = Budget(self._job["load_budget_s"]) if several else self._budget
            recorder.cell, recorder.places = name, published
            linecache.cache[name] = (len(source), None, source.splitlines(keepends=True), name)
            began = process_time()
            for piece in pieces(source):
                self._run(piece, name, recorder, published=published)
            if self._job["notebook"] and not deferred_libraries.lacks("matplotlib"):
                # as Jupyter does, so that pyplot begins a new figure in the next cell
                sys.modules["guest.headless_matplotlib"].close_figures()
            if several:
                peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
                self.costs.append((name, process_time() - began, peak_mb))

    def missing(self, names: list[str]) -> list[str]:
        """Return those of the names that are not written because a statement failed."""
        return [
            name
            for name in names
            if name in self.statements.causes and not is_written(self._names.get(name), True)
        ]

    def _run(self, piece: str, name: str, recorder: Recorder, *, published: bool) -> None:
        before, failed = animate.shown[:], len(self.statements.failures)
        self._shown = before
        self.statements.cell = name
        self.statements.goes_on = recorder.has_raised if published else lambda error: False
        # a submission can change how IPython reads and runs a cell
        run = self._as_script if published and is_python(piece) else self._run_piece
        with self._in_place(recorder) if published else nullcontext():
            stray = limited(lambda: run(piece, name), self._budget)
            if not self._budget.left():
                self._stop(name)
                stray = limited(lambda: run(piece, name), self._budget)
        self.shows = self.shows if animate.shown == before else piece
        if stray is not None and not isinstance(stray, OutOfTime):
            self.statements.failures.append(stray)
        for error in self.statements.failures[failed:][:1]:
            if not recorder.has_raised(error):  # else its line says so
                ended = self._ended(error)
                if published and isinstance(error, MemoryError):
                    ended["sentence"] = GIVEN_MEMORY
                self._write.event("cell", cell=name, **ended)
        for place in self.statements.exits:
            shown = f'  File "{name}", line {place.line}\n{linecache.getline(name, place.line)}'
            self._write.event("cell", cell=name, ended="exited", sentence=LEFT_OUT_EXIT, traceback=shown)
        self.statements.exits.clear()

    @contextmanager
    def _in_place(self, recorder: Recorder) -> Iterator[None]:
        """Let a published cell run with modules and builtins that the submission has not changed. Its claims
        count for nothing if the submission changes them meanwhile.
        """
        assert self._given is not None
        with self._given.in_place(self._names):
            yield
        if self._given.changed:
            self._write.event("left-out", cell=recorder.cell, sentence=self._given.changed)

    def _stop(self, name: str) -> None:
        """Stop, or if no other process may start, let only definitions run from now on."""
        sentence, costliest = self._budget.sentence(), self.statements.costliest()
        if costliest is not None and not self.statements.only_definitions and self._job["may_run_again"]:
            self._write.event("stopped", sentence=sentence, **costliest._asdict())
            raise Stopped
        self._write.event(
            "cell", cell=name, ended="timed-out", code="timeout", sentence=sentence + ONLY_DEFINITIONS
        )
        self.statements.only_definitions = Cause(f"{name} stopped: {sentence}", "timeout", None)
        self._budget = Budget(DEFINITIONS_S)

    def _ended(self, error: BaseException) -> dict[str, Any]:
        return ending(error, self._budget, self.statements.cause(error))

    def _begin(self, place: Place) -> None:
        self._write.event("statement", cell=place.cell, line=place.line, column=place.column)

    def _in_shell(self, module: types.ModuleType) -> Callable[[str, str], None]:
        """Return the function that runs a piece as a notebook's cell."""
        shell = sys.modules["guest.cells.shell"].Shell.instance()
        shell.open(module, self._attempts)

        def run(source: str, name: str) -> None:
            if (error := shell.run(source, name)) is not None:
                self.statements.cannot_parse(source, error)

        return run

    def _as_script(self, source: str, name: str) -> None:
        """Run a piece of a Python file."""
        try:
            tree = ast.parse(source, name)
            future = [n for n in tree.body if isinstance(n, ast.ImportFrom) and n.module == "__future__"]
            compile(tree, name, "exec")
        except (SyntaxError, ValueError, MemoryError, RecursionError) as error:
            self.statements.cannot_parse(source, error)
            return
        for attempt in self._attempts(tree.body):
            try:
                exec(compile(ast.Module([*future, attempt.node], []), name, "exec"), self._names)
            except BaseException as error:
                attempt.error = error

    def _attempts(self, nodes: list[ast.stmt]) -> Iterator[Attempt]:
        """Yield the statements that run, until their time is spent. A displayed animation is shown."""
        for attempt in self.statements.run(nodes):
            yield attempt
            self._keep_shown()
            end_if_full()
            self._replaced |= {
                name: self._names[name]
                for name, value in self._fixed.items()
                if self._names.get(name, value) is not value
            }
            self._names |= self._fixed
            if not self._budget.left():
                attempt.error = attempt.error or OutOfTime()
        self._show_last(nodes)

    def _show_last(self, nodes: list[ast.stmt]) -> None:
        """Show the animation that a cell ends with, as a notebook displays it."""
        last = nodes[-1].value if nodes and isinstance(nodes[-1], ast.Expr) else None
        value = self._names.get(last.id) if isinstance(last, ast.Name) else None
        if deferred_libraries.lacks("matplotlib"):
            return
        if isinstance(value, sys.modules["matplotlib.animation"].Animation):
            animate.shown[:] = [value]
            self._keep_shown()

    def _keep_shown(self) -> None:
        """Keep the names and their values if an animation has been shown."""
        if animate.shown != self._shown:
            self._shown, self.names_shown = animate.shown[:], dict(self._names)
