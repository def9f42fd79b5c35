"""IPython's shell without a terminal, history or threads: a notebook's cells run as Jupyter runs them.

It replaces what needs another process, a socket or the student's screen: shell escapes say in one line that
there is no shell, ``%timeit`` runs its statement once, GUI backends draw with Agg, ``display`` prints plain
text, and ``await`` runs in an event loop that only sleeps.
"""

import ast
import os
import types
from collections.abc import Callable, Iterator
from typing import Any

from IPython.core.compilerop import CachingCompiler
from IPython.core.display_functions import display
from IPython.core.displayhook import DisplayHook
from IPython.core.history import HistoryManager
from IPython.core.interactiveshell import ExecutionResult, InteractiveShell
from IPython.utils.text import SList
from traitlets import Type

from . import event_loop
from .magics import OwnMagics
from .shell_commands import run_command
from .statements import Attempt

MOST_AUTOMAGICS = 20  # lines of one cell
INCOMPLETE_INPUT = 0x4000  # codeop.PyCF_ALLOW_INCOMPLETE_INPUT: "incomplete input" in place of the reason

Attempts = Callable[[list[ast.stmt]], Iterator[Attempt]]


class Shell(InteractiveShell):
    """The shell of a submission. ``attempts`` chooses the statements of a cell that run, and is told their
    errors.
    """

    compiler_class = Type(CachingCompiler)
    displayhook_class = Type(DisplayHook)

    def __init__(self) -> None:
        self.attempts: Attempts = _all
        self.blank_lines = 0  # at the beginning of the cell that runs
        super().__init__(ipython_dir="/", user_module=types.ModuleType("__main__"), colors="nocolor")
        self.db: dict[str, Any] = {}  # what a profile would keep: %cd and %bookmark use it
        assert self.display_formatter is not None
        self.display_formatter.active_types = ["text/plain"]
        self._loop = event_loop.install()
        self.loop_runner = lambda coroutine: event_loop.run(self._loop, coroutine)
        self.input_transformers_post.append(self._with_automagics)
        self.set_hook("show_in_pager", lambda shell, data, start, screen_lines: print(_plain(data)))
        self._own = OwnMagics(self)

    def open(self, module: types.ModuleType, attempts: Attempts) -> None:
        """Run the cells that follow in the namespace of ``module``."""
        self.user_module, self.user_ns, self.attempts = module, module.__dict__, attempts
        self.home_dir = os.path.expanduser("~")  # of the child, not of the zygote
        self.init_user_ns()
        self.user_ns["display"] = display

    def run(self, source: str, name: str) -> BaseException | None:
        """Run a cell, whose lines have the file name ``name``. Return the error if it cannot be parsed."""
        self.compile.name = name
        self.blank_lines = _blank_lines(source)
        return self.run_cell(source, store_history=True).error_before_exec

    async def run_ast_nodes(
        self,
        nodelist: list[ast.stmt],
        cell_name: str,
        interactivity: str = "last_expr",
        compiler: Any = compile,
        result: ExecutionResult | None = None,
    ) -> bool:
        """Run the attempts at these statements one by one. Return whether one of them failed."""
        failed = False
        for attempt in self.attempts(nodelist):
            shown = interactivity if attempt.last or interactivity == "all" else "none"
            own = ExecutionResult(None)
            if await super().run_ast_nodes([attempt.node], cell_name, shown, compiler, own):
                attempt.error, failed = own.error_in_exec or own.error_before_exec, True
        return failed

    def transform_cell(self, raw_cell: str) -> str:
        """Return the cell as Python, with the blank lines that it begins with: lines keep their numbers."""
        return "\n" * _blank_lines(raw_cell) + super().transform_cell(raw_cell)

    def init_profile_dir(self, profile_dir: Any) -> None:
        """Use no profile: it would be files."""
        self.profile_dir = None

    def init_history(self) -> None:
        """Keep the history in memory."""
        self.history_manager = HistoryManager(shell=self, parent=self, enabled=False, hist_file=":memory:")
        self.configurables.append(self.history_manager)

    def init_virtualenv(self) -> None:
        """Leave sys.path as it is."""

    def showtraceback(self, *args: Any, **kwargs: Any) -> None:
        """Print nothing: the report has the student's part of a traceback."""

    showsyntaxerror = showtraceback

    def _format_exception_for_storage(self, *args: Any, **kwargs: Any) -> dict[str, Any]:
        return {}

    def enable_matplotlib(self, gui: str | None = None) -> tuple[str | None, str]:
        """Draw with Agg, whatever backend is named."""
        return gui, "agg"

    def enable_gui(self, gui: str | None = None) -> None:
        """Start no event loop of a screen."""

    def ask_exit(self) -> None:
        """End the cell, as ``exit`` in Jupyter ends the kernel."""
        raise SystemExit

    def system(self, cmd: str) -> None:
        """Run what a command does here."""
        run_command(cmd)

    def getoutput(self, cmd: str, split: bool = True, depth: int = 0) -> Any:
        """Run what a command does here, and return its empty answer."""
        self.system(cmd)
        return SList() if split else ""

    def run_line_magic(self, magic_name: str, line: str, _stack_depth: int = 1) -> Any:
        """Run a line magic, or what stands for it here."""
        if own := self._own.line.get(magic_name):
            return own(line)
        return super().run_line_magic(magic_name, line, _stack_depth + 1)

    def run_cell_magic(self, magic_name: str, line: str, cell: str) -> Any:
        """Run a cell magic, or what stands for it here."""
        if own := self._own.cell.get(magic_name):
            return own(line, cell)
        return super().run_cell_magic(magic_name, line, cell)

    def _with_automagics(self, lines: list[str]) -> list[str]:
        """Return the lines with magics that lack their %, which IPython itself knows only in a cell of one
        line.
        """
        for _ in range(MOST_AUTOMAGICS):
            try:
                self.compile.ast_parse("".join(lines))
                return lines
            except SyntaxError as error:
                number = (error.lineno or 0) - 1
            except (ValueError, MemoryError, RecursionError):
                return lines
            line = lines[number] if 0 <= number < len(lines) else ""
            with self.builtin_trap:
                magic = self.prefilter_manager.prefilter_lines(line.rstrip("\n")) + "\n"
            if magic == line or "get_ipython()" not in magic:
                return lines
            lines = [*lines[:number], magic, *lines[number + 1 :]]
        return lines


class _Hook(DisplayHook):
    """A display hook that sets ``_`` and ``Out`` and prints nothing."""

    def __call__(self, result: Any = None) -> None:
        self.check_for_underscore()
        if result is not None and not self.quiet():
            self.update_user_ns(result)
            self.fill_exec_result(result)


class _Compiler(CachingCompiler):
    """A compiler that gives the lines of the cell that runs the file name ``name``, and the errors that a
    Python file gets.
    """

    name = "cell"

    def __init__(self) -> None:
        super().__init__()
        self.flags &= ~INCOMPLETE_INPUT

    def cache(self, transformed_code: str, number: int = 0, raw_code: str | None = None) -> str:
        """Return the name. The lines themselves are known by it already."""
        return self.name


Shell.displayhook_class.default_value, Shell.compiler_class.default_value = _Hook, _Compiler


def _all(nodes: list[ast.stmt]) -> Iterator[Attempt]:
    """Run every statement until one fails."""
    for node in nodes:
        yield (attempt := Attempt(node, last=node is nodes[-1]))
        if attempt.error is not None:
            return


def _blank_lines(source: str) -> int:
    return source.count("\n", 0, len(source) - len(source.lstrip()))


def _plain(data: Any) -> str:
    return str(data.get("text/plain", "") if isinstance(data, dict) else data)


def warm_up() -> None:
    """Create the shell and run what each notebook runs, so that no child has to do it first."""
    shell = Shell.instance()
    for source in ("1\n_", "import nothing_of_that_name"):
        shell.run(source, "cell")
    shell.reset()
