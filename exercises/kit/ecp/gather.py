"""The source of a student's functions and of all they need, collected from a live notebook as one text that runs alone.

A name is sent as what it is now: a number as its value, a function as the text that made the current one, a library's function
as its import. What no text can give is left out and told.
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

from ecp.errors import NotebookError
from ecp.notebook.all_cells import whole
from ecp.notebook.dependencies import Bundling
from ecp.notebook.history import History
from ecp.notebook.sources import Sources
from ecp.return_value import is_written


class CannotSend(NotebookError):
    """Something asked for cannot be sent; the message says why and what to do."""


@dataclass(frozen=True)
class LeftOut:
    """A name that ``needed_by`` uses and that is not sent. ``sentence`` says what it is and what to do about it."""

    name: str
    needed_by: str
    sentence: str


@dataclass(frozen=True)
class Bundle:
    """What is sent: ``source`` under a file name that says how to read it.

    Gathered, it runs alone with ``exec`` and defines ``names``, which were asked for; of a whole notebook they are what can be
    called.
    """

    source: str
    names: tuple[str, ...] = ()
    left_out: tuple[LeftOut, ...] = ()
    filename: str = "submission.py"

    @property
    def sha256(self) -> str:
        """Of the source as UTF-8, in hexadecimal digits."""
        return hashlib.sha256(self.source.encode("utf-8", "replace")).hexdigest()


def gather(
    *functions: Any,
    namespace: Mapping[str, Any] | None = None,
    cells: Sequence[str] | None = None,
    given: Collection[str] = (),
) -> Bundle:
    """The functions, or names of functions, with everything of the notebook they need.

    ``namespace`` and ``cells`` (raw, oldest first) are those of the running notebook unless told. ``given`` names stand ready
    where the text will run. Raises ``CannotSend`` where something asked for has no source.
    """
    if not functions:
        raise CannotSend("say what to send: the function, such as euler_eqs, or its name")
    namespace = _live_namespace() if namespace is None else namespace
    values = dict(namespace)
    names = tuple(_name_of(function, values) for function in functions)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of a "\o" in a label the student was told when the cell ran
        sources = Sources(namespace, values, History(_live_cells() if cells is None else cells))
        bundling = Bundling(sources, names, given)
    for name in names:
        if name in bundling.missing:
            raise CannotSend(bundling.missing[name])
    return Bundle(bundling.text(), names, tuple(LeftOut(*told) for told in bundling.left_out()))


def whole_notebook(cells: Sequence[str] | None = None) -> Bundle:
    """All code that ran, in the order of its last run, as a notebook: a cell that fails there does not stop the others."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        sources = whole(_live_cells() if cells is None else cells)
    told: list[dict[str, Any]] = [
        {"cell_type": "code", "source": source, "metadata": {}, "outputs": [], "execution_count": None} for source in sources
    ]
    notebook = {"cells": told, "metadata": {}, "nbformat": 4, "nbformat_minor": 4}
    names = _live_namespace() if cells is None else {}
    written = tuple(name for name, value in names.items() if not name.startswith("_") and is_written(value))
    return Bundle(json.dumps(notebook, ensure_ascii=False), written, filename="notebook.ipynb")


def _name_of(function: Any, values: dict[str, Any]) -> str:
    """The name under which the notebook knows it; a function that has lost its name to a newer one gets it back for this call."""
    if isinstance(function, str):
        if function not in values:
            raise CannotSend(f"nothing is called `{function}` here: run the cell that defines it first")
        return function
    own = str(getattr(function, "__name__", ""))
    others = [name for name, value in values.items() if value is function and not name.startswith("_")]
    if values.get(own) is not function and others:
        return others[0]
    if not own.isidentifier():
        what = "a function without a name" if inspect.isfunction(function) else f"of the type {type(function).__name__}"
        raise CannotSend(f"what you hand in is {what}: save it in a cell under the name it is asked for, and hand in that name")
    values[own] = function
    return own


def _live_namespace() -> dict[str, Any]:
    shell = _shell()
    return shell.user_ns if shell else vars(sys.modules["__main__"])


def _live_cells() -> list[str]:
    """What was typed, as it was typed; of a script, its text."""
    shell = _shell()
    if shell:
        return list(shell.history_manager.input_hist_raw)
    script = getattr(sys.modules["__main__"], "__file__", None)
    return [Path(script).read_text(encoding="utf-8")] if script and Path(script).is_file() else []


def _shell() -> Any:
    IPython = sys.modules.get("IPython")  # a notebook has it loaded
    return IPython.get_ipython() if IPython else None
