"""Questions about variables that a cell assigns, and claims about several of them."""

import ast
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ecp.kinds.asking import KNOWN
from ecp.outcome import Tolerance
from exercises.question import Mistake, Question, Value, calling_line

CLAIMED = Tolerance(rtol=1e-9, reason="compared by claims only")


@dataclass(frozen=True)
class Claim:
    """A claim about variables: an expression that must be true, everywhere if it is an array."""

    text: str
    label: str
    reason: str

    def names(self) -> list[str]:
        """Return the variables that the expression uses."""
        nodes = ast.walk(ast.parse(self.text, mode="eval"))
        return list(dict.fromkeys(n.id for n in nodes if isinstance(n, ast.Name) and n.id not in KNOWN))


def claim(text: str, label: str, *, reason: str) -> Claim:
    """Return a claim such as ``"growth_min < 0.05 < growth_mid"``, with its label in the report and its reason."""
    return Claim(text, label, reason)


def variables(
    solution: Callable[[], Any],
    truth: Mapping[str, Any] | None = None,
    *,
    agree: Mapping[str, Value | Tolerance] | None = None,
    claims: tuple[Claim, ...] | list[Claim] = (),
    mistakes: tuple[Mistake, ...] | list[Mistake] = (),
    budget_s: float = 5.0,
    uses: Sequence[Callable[..., Any]] = (),
) -> Question:
    """Return the question for the variables that a cell assigns: the body of ``solution`` without its return statement.

    ``truth`` maps names to exact numbers and arrays, or to functions without parameters that compute them; ``agree`` maps the same
    names to tolerances. A claim may use further variables. A student can type a number: where a function can be asked instead,
    with other inputs, that check is stronger.
    """
    compared = dict(agree or {})
    names = tuple(dict.fromkeys([*compared, *(name for one in claims for name in one.names())]))
    return Question(
        kind="variables",
        solution=solution,
        ask={},
        values={name: _value(name, compared.get(name, CLAIMED)) for name in names},
        keys=True,
        known=dict(truth or {}),
        variables=names,
        data={
            "compared": list(compared),
            "claims": [{"text": c.text, "label": c.label, "reason": c.reason, "names": c.names()} for c in claims],
        },
        mistakes=tuple(mistakes),
        budget_s=budget_s,
        uses=tuple(uses),
        line=calling_line(),
    )


def _value(name: str, value: Value | Tolerance) -> Value:
    whole = value if isinstance(value, Value) else Value(value)
    return replace(whole, label=whole.label or f"{name} is right")
