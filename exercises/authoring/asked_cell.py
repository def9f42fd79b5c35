"""Variables that a solution cell assigns, as an exercise asks for them."""

import functools
import inspect
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from exercises.authoring.asked_solution import AskedSolution, DeclarationError
from exercises.authoring.kinds.variables import Claim, variables
from exercises.authoring.questions.author_arguments import Value
from exercises.authoring.questions.question import Question
from exercises.authoring.solutions import NotebookSolution
from polhode.judging.outcome import Tolerance

Function = Callable[..., Any]


@dataclass(eq=False)
class AskedCell(AskedSolution):
    """A cell that assigns the variables ``names``. ``given`` are constants of the notebook that its truths
    take. The author adds truths, claims and mistakes.
    """

    names: tuple[str, ...]
    given: tuple[str, ...]
    truths: dict[str, Any] = field(default_factory=dict, kw_only=True)
    tolerances: dict[str, Tolerance | Value] = field(default_factory=dict, kw_only=True)
    claims: list[Claim] = field(default_factory=list, kw_only=True)

    def truth(self, name: str, value: Any = None, *, agree: Tolerance | Value | None = None) -> Any:
        """Set the exact ``value`` of a variable, or decorate the function of the given constants that
        computes it. ``agree`` is its tolerance.
        """
        line = sys._getframe(1).f_lineno
        if name not in self.names or agree is None:
            each = f'@cell.truth("{self.names[0]}", agree=…)'
            raise DeclarationError(
                f"each variable of a cell has its own truth and tolerance: write {each} for one of"
                f" {', '.join(self.names)}",
                line,
            )
        self.tolerances[name] = agree

        def decorate(function: Function) -> Function:
            self.truths[name] = self._with_given(function)
            return function

        if value is None:
            return decorate
        self.truths[name] = value
        return None

    def claim(self, text: str, label: str, *, because: str) -> None:
        """Add a claim about the variables, such as ``"growth_min < 0.05 < growth_max"``, and its reason."""
        self.claims.append(Claim(text, label, because))

    def questions(self, uses: Sequence[NotebookSolution]) -> list[Question]:
        """Return the question for the variables; ``uses`` are the earlier solutions that the cell calls."""
        compared = {name: self.tolerances[name] for name in self.names if name in self.tolerances}
        claimed = {name for claim in self.claims for name in claim.names()}
        if missing := [name for name in self.names if name not in {*compared, *claimed}]:
            raise DeclarationError(
                f"{', '.join(missing)} has no truth and no claim: give one, or do not ask for it", self.line
            )
        question = variables(
            self.solution, dict(self.truths), agree=compared, claims=list(self.claims), uses=list(uses)
        )
        return [replace(question, mistakes=tuple(self.mistakes), line=self.line)]

    def _with_given(self, function: Function) -> Function:
        """Return a truth without parameters, from one that takes constants of the notebook."""
        taken = list(inspect.signature(function).parameters)
        if unknown := [name for name in taken if name not in self.given]:
            raise DeclarationError(
                f"the truth {function.__name__} takes {', '.join(unknown)}: name the constants of the"
                " notebook that it needs in given=",
                function.__code__.co_firstlineno,
            )

        @functools.wraps(function)
        def exact() -> Any:
            names = self.solution.names
            return function(**{name: names[name] for name in taken})

        exact.__signature__ = inspect.Signature()  # type: ignore[attr-defined]
        return exact
