"""Questions about variables that a cell assigns, and claims about several of them."""

import ast
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from exercises.authoring.kinds import kind
from exercises.authoring.questions.declared import Expression, Named, Numbers, Text, Value
from exercises.authoring.questions.question import Question
from polhode.judging.outcome import Tolerance
from polhode.kinds.asking import KNOWN

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


def claim(text: str, label: str, *, reason: str) -> Claim:
    """Return a claim such as ``"growth_min < 0.05 < growth_mid"``, with its label in the report and its
    reason.
    """
    return Claim(text, label, reason)


@kind(rows=None)
def variables(
    solution: Callable[[], Any],
    truth: Mapping[str, Named | Numbers] | None = None,
    *,
    agree: Mapping[str, Tolerance | Value] | None = None,
    claims: Sequence[Claim] = (),
) -> Question:
    """Return the question for the variables that a cell assigns: the body of ``solution`` without its return
    statement.

    ``truth`` maps names to exact numbers and arrays, or to functions without parameters that compute them;
    ``agree`` maps the same names to tolerances. A claim may use further variables. A student can type a
    number: where a function can be asked instead, with other inputs, that check is stronger.
    """
    compared = dict(agree or {})
    names = tuple(dict.fromkeys([*compared, *(name for one in claims for name in one.names())]))
    if not names:
        raise ValueError("it asks for no variable: give agree or claims")
    values = {
        n: v if isinstance(v, Value) else Value(v)
        for n, v in (dict.fromkeys(names, CLAIMED) | compared).items()
    }
    return Question(
        kind="variables",
        solution=solution,
        ask={},
        values={
            name: replace(value, label=value.label or f"{name} is right") for name, value in values.items()
        },
        keys=True,
        known=dict(truth or {}),
        variables=names,
        data={
            "compared": list(compared),
            "claims": [
                {"text": c.text, "label": c.label, "reason": c.reason, "names": c.names()} for c in claims
            ],
        },
    )
