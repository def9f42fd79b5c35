"""Questions about variables that a cell assigns, and claims about several of them."""

import ast
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from exercises.authoring.kinds import kind
from exercises.authoring.questions.author_arguments import (
    Expression,
    Named,
    Numbers,
    Text,
    Value,
    named_values,
)
from exercises.authoring.questions.question import Question
from exercises.authoring.solutions import NotebookSolution
from polhode.judging.outcome import Tolerance
from polhode.kinds.student_calls import KNOWN

CLAIMED = Tolerance(rtol=1e-9, reason="compared by claims only")


@dataclass(frozen=True)
class Claim:
    """A claim about variables: an expression that must be true, everywhere if it is an array."""

    text: Expression
    label: Text
    reason: Text

    def names(self) -> list[str]:
        """Return the variables that the expression uses."""
        nodes = ast.walk(ast.parse(self.text, mode="eval"))
        return list(dict.fromkeys(n.id for n in nodes if isinstance(n, ast.Name) and n.id not in KNOWN))


@kind(rows=None)
def variables(
    solution: NotebookSolution,
    truth: Mapping[str, Named | Numbers],
    *,
    agree: Mapping[str, Tolerance | Value],
    claims: Sequence[Claim] = (),
) -> Question:
    """Return the question for the variables that a cell, the ``solution``, assigns.

    ``truth`` maps names to exact numbers and arrays, or to functions without parameters that compute them;
    ``agree`` maps the same names to tolerances. A claim may use further variables. A student can type a
    number: where a function can be asked instead, with other inputs, that check is stronger.
    """
    names = tuple(dict.fromkeys([*agree, *(name for one in claims for name in one.names())]))
    values = named_values(dict.fromkeys(names, CLAIMED) | dict(agree))
    return Question(
        kind="variables",
        solution=solution,
        inputs={},
        values={
            name: replace(value, label=value.label or f"{name} is right") for name, value in values.items()
        },
        keys=True,
        known=dict(truth),
        variables=names,
        data={
            "compared": list(agree),
            "claims": [
                {"text": c.text, "label": c.label, "reason": c.reason, "names": c.names()} for c in claims
            ],
        },
    )
