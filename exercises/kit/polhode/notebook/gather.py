"""The source of a student's functions and everything they need, collected from a live notebook as one
self-contained text.

A name is sent as its current value: a number as its value, a function as the text that defined it, a
library's function as its import. What cannot be written as text is left out and reported.
"""

import hashlib
import inspect
import json
import sys
import warnings
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from polhode.client.errors import NotebookError
from polhode.judging.return_value import is_written
from polhode.notebook.cell_history import History
from polhode.notebook.dependencies import Bundling
from polhode.notebook.executed_cells import whole
from polhode.notebook.name_sources import Sources


class CannotSend(NotebookError):
    """The submission cannot be assembled; the message says why and what to do."""


@dataclass(frozen=True)
class LeftOut:
    """A name that ``needed_by`` uses but that is not sent. ``sentence`` says what it is and what to do."""

    name: str
    needed_by: str
    sentence: str


@dataclass(frozen=True)
class Bundle:
    """A submission: ``source``, and a file name whose suffix says how to read it.

    A gathered source runs alone with ``exec`` and defines ``names``, the functions asked for. For a whole
    notebook they are all names it defines.
    """

    source: str
    names: tuple[str, ...] = ()
    left_out: tuple[LeftOut, ...] = ()
    filename: str = "submission.py"

    @property
    def sha256(self) -> str:
        """Return the SHA-256 of the source as UTF-8, in hexadecimal."""
        return hashlib.sha256(self.source.encode("utf-8", "replace")).hexdigest()


def gather(
    *functions: Any,
    namespace: Mapping[str, Any] | None = None,
    cells: Sequence[str] | None = None,
    given: Collection[str] = (),
) -> Bundle:
    """Return the functions, given as objects or names, with everything of the notebook they need.

    ``namespace`` and ``cells`` (raw text, oldest first) default to those of the running notebook. ``given``
    names exist already where the text will run. Raises CannotSend if a function asked for has no source.
    """
    if not functions:
        raise CannotSend("name what to submit: a function such as euler_eqs, or its name")
    namespace = _live_namespace() if namespace is None else namespace
    values = dict(namespace)
    names = tuple(_name_of(function, values) for function in functions)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # Python warned of a "\o" in a label already when the cell ran
        sources = Sources(namespace, values, History(_live_cells() if cells is None else cells))
        bundling = Bundling(sources, names, given)
    for name in names:
        if name in bundling.missing:
            raise CannotSend(bundling.missing[name])
    return Bundle(bundling.text(), names, tuple(LeftOut(*row) for row in bundling.left_out()))


def whole_notebook(cells: Sequence[str] | None = None) -> Bundle:
    """Return all code that ran as a notebook, each cell in the order of its last run. A cell that fails there
    does not stop the others.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        sources = whole(_live_cells() if cells is None else cells)
    code: list[dict[str, Any]] = [
        {"cell_type": "code", "source": source, "metadata": {}, "outputs": [], "execution_count": None}
        for source in sources
    ]
    notebook = {"cells": code, "metadata": {}, "nbformat": 4, "nbformat_minor": 4}
    names = _live_namespace() if cells is None else {}
    written = tuple(
        name for name, value in names.items() if not name.startswith("_") and is_written(value, variable=True)
    )
    return Bundle(json.dumps(notebook, ensure_ascii=False), written, filename="notebook.ipynb")


def _name_of(function: Any, values: dict[str, Any]) -> str:
    """Return the function's name in the notebook. If a newer value took its name, the function gets it back
    for this call.
    """
    if isinstance(function, str):
        if function not in values:
            raise CannotSend(f"`{function}` is not defined: run the cell that defines it first")
        return function
    own = str(getattr(function, "__name__", ""))
    others = [name for name, value in values.items() if value is function and not name.startswith("_")]
    if values.get(own) is not function and others:
        return others[0]
    if not own.isidentifier():
        what = (
            "a function without a name"
            if inspect.isfunction(function)
            else f"a value of the type {type(function).__name__}"
        )
        remedy = "define a function in a cell with `def`, under the name the exercise gives, and submit that"
        raise CannotSend(f"cannot submit {what}: {remedy}")
    values[own] = function
    return own


def _live_namespace() -> dict[str, Any]:
    shell = _shell()
    return shell.user_ns if shell else vars(sys.modules["__main__"])


def _live_cells() -> list[str]:
    """Return the cells as typed; of a script, its text."""
    shell = _shell()
    if shell:
        return list(shell.history_manager.input_hist_raw)
    script = getattr(sys.modules["__main__"], "__file__", None)
    return [Path(script).read_text(encoding="utf-8")] if script and Path(script).is_file() else []


def _shell() -> Any:
    IPython = sys.modules.get("IPython")  # a notebook has it loaded
    return IPython.get_ipython() if IPython else None
