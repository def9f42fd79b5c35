"""Functions of a test module, and cells, as solutions of a notebook."""

import inspect
import sys
import textwrap
from pathlib import Path

from exercises.authoring.questions.author_notebook import Cell
from exercises.authoring.solutions import Solutions


def solution(function):
    """The function as the one solution of a notebook, whose other names are those that it sees here."""
    module = sys.modules[function.__module__]
    made = Solutions(
        [Cell("code", textwrap.dedent(inspect.getsource(function)))], Path(module.__file__).parent
    )
    made.names = {**vars(module), **inspect.getclosurevars(function).nonlocals}
    return made.function(function.__name__)


def cell(source, *names):
    """The cell as the solution that assigns these names."""
    made = Solutions([Cell("code", source)], Path())
    made.names = {}
    return made.cell(names)
