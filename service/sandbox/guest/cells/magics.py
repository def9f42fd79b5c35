"""Magics in place of IPython's own: some say that there is no shell, those that time run their text once."""

import re
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .shell import Shell

NO_PROCESS = (
    "script",
    "bash",
    "sh",
    "python",
    "python2",
    "python3",
    "pypy",
    "ruby",
    "perl",
    "system",
    "sx",
    "!",
)
INSTALLERS = ("pip", "conda", "mamba", "micromamba", "uv")
TIMEIT_OPTION = re.compile(r"\s*-(?:[nr]\s*\d+|[tcqo]\b|[pv]\s*\S+)")
EXTENSIONS = ("autoreload",)  # nothing changes here while a notebook runs


class OwnMagics:
    """The replaced magics of a shell: of a ``line`` and of a ``cell``, by name."""

    def __init__(self, shell: "Shell") -> None:
        self._shell = shell
        self.line: dict[str, Callable[..., Any]] = {
            **{name: partial(self._no_process, name) for name in INSTALLERS},
            **dict.fromkeys(("autoreload", "aimport"), _nothing),
            "config": self._config,
            "load_ext": self._load_ext,
            "timeit": self._timeit,
        }
        self.cell: dict[str, Callable[..., Any]] = {
            **{name: partial(self._no_process, f"%%{name}") for name in NO_PROCESS},
            "capture": self._capture,
            "time": self._time,
            "timeit": self._timeit,
        }

    def _no_process(self, name: str, line: str, cell: str = "") -> None:
        self._shell.system(f"{name} {line}")

    def _config(self, line: str) -> Any:
        """Set a configuration, but not that of a front end."""
        return None if line.startswith("InlineBackend") else self._original("line", "config", line)

    def _load_ext(self, line: str) -> Any:
        return None if line.strip() in EXTENSIONS else self._original("line", "load_ext", line)

    def _time(self, line: str, cell: str) -> None:
        self._shell.run_cell(self._below(cell))

    def _capture(self, line: str, cell: str) -> Any:
        return self._original("cell", "capture", line, self._below(cell))

    def _below(self, cell: str) -> str:
        """Return the text below a cell magic at its own lines, after empty ones."""
        return "\n" * (self._shell.blank_lines + 1) + cell

    def _timeit(self, line: str, cell: str | None = None) -> Any:
        """Run a statement, or the cell below, once."""
        options = ""
        while found := TIMEIT_OPTION.match(line):
            options += "" if found[0].strip()[1] in "nr" else found[0]
            line = line[found.end() :]
        return self._original("line", "timeit", f"-n1 -r1 {options} {line}", cell)

    def _original(self, kind: str, name: str, *arguments: Any) -> Any:
        return self._shell.magics_manager.find(kind, name)(*arguments)


def _nothing(line: str) -> None:
    """Do nothing."""
