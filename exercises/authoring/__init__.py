"""What an author writes an ``assignment.py`` with: see docs/authors.md and docs/authors/."""

from exercises.authoring.ask import Ask
from exercises.authoring.draws import (
    angle,
    array_of,
    between,
    expression,
    function,
    in_turn,
    integer,
    normal,
    one_of,
    with_ends,
)
from exercises.authoring.kinds.dynamics import Sensitivity
from exercises.authoring.kinds.expression import symbol
from exercises.authoring.kinds.random import generator, seed
from exercises.authoring.kinds.stepper import euler, heun, midpoint, rk4, tableau
from exercises.authoring.notebook_declaration import Notebook
from exercises.authoring.questions.author_arguments import Value
from exercises.authoring.tolerances import absolute, at_most, close, relative

__all__ = [
    "Ask",
    "Notebook",
    "Sensitivity",
    "Value",
    "absolute",
    "angle",
    "array_of",
    "at_most",
    "between",
    "close",
    "euler",
    "expression",
    "function",
    "generator",
    "heun",
    "in_turn",
    "integer",
    "midpoint",
    "normal",
    "one_of",
    "relative",
    "rk4",
    "seed",
    "symbol",
    "tableau",
    "with_ends",
]
