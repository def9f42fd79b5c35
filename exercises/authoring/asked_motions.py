"""A right-hand side and the motions that it drives, as exercises ask for them: the first one asks for its
values and says what is exact, later ones ask for it again and add motions.
"""

import inspect
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any

from exercises.authoring.asked_solution import Asked, AskedSolution, DeclarationError
from exercises.authoring.draws import JointDraw
from exercises.authoring.kinds.dynamics import Driven, Dynamics, HiddenMotion, Motion, chart
from exercises.authoring.questions.author_arguments import tolerance_data
from exercises.authoring.questions.question import Question
from exercises.authoring.solutions import NotebookSolution
from polhode.judging.outcome import Tolerance

Function = Callable[..., Any]


@dataclass(eq=False)
class AskedMotion:
    """One or several motions of a function, about which an exercise makes checks.

    Their functions belong to the module ``shown``, which students get too, and take the motion's time, state,
    parameters and ``R`` by name, and the exact ones as ``exact_NAME``; of several motions lists of them.
    """

    asked: "Motions"
    motions: tuple[Motion, ...]

    def conserves(self, name: str, label: str, quantity: FunctionType, limit: Tolerance) -> None:
        """Check that a ``quantity`` (n,) keeps its first value to a relative ``limit``."""
        self._check(name, label, "conserved", limit, quantity)

    def agrees(
        self, name: str, label: str, measured: FunctionType, tolerance: Tolerance, *, exact: Any
    ) -> None:
        """Check that what is ``measured`` is ``exact``: numbers, or a function of the exact motion."""
        self.motions[0].known[name] = exact
        self._check(name, label, "close", tolerance, measured)

    def stays_below(self, name: str, label: str, measured: FunctionType, limit: Tolerance) -> None:
        """Check that what is ``measured`` is at most the ``limit``."""
        self._check(name, label, "below", limit, measured)

    def holds(self, name: str, label: str, claim: FunctionType, *, because: str) -> None:
        """Check a ``claim``, which returns whether it holds and the text for the brackets."""
        self._check(name, label, "holds", Tolerance(reason=because), claim)

    def follows_exactly(self, name: str, label: str, *, attitude: bool = False) -> None:
        """Check that the state, or the ``attitude``, follows the exact motion as closely as any integrator
        must, here and at points along it.
        """
        array = "R" if attitude else self.asked.dynamics.state
        self._check(name, label, "follows", Tolerance(reason="see the sensitivity"), None, array=array)

    def plays(self, name: str, title: str, alt: str, *, half: Sequence[float], axis: int) -> None:
        """Show the attitude of the motion beside the exact one as a turning box with half edges ``half``."""
        (motion,) = self.motions
        known = {"name": name, "title": title, "alt": alt, "scene": motion.name}
        self.asked.players.append(known | {"half": [float(x) for x in half], "axis": axis})

    def _check(
        self,
        name: str,
        label: str,
        word: str,
        tolerance: Tolerance,
        measured: FunctionType | None,
        **more: Any,
    ) -> None:
        self.asked.checks.append(
            {
                "name": name,
                "label": label,
                "word": word,
                "of": [motion.name for motion in self.motions],
                "tolerance": tolerance_data(tolerance),
                **({"measured": self.asked.portable(measured)} if measured else {}),
                **more,
            }
        )


class Motions:
    """What one exercise asks of the motions of a function."""

    dynamics: Dynamics
    shown: ModuleType | None
    checks: list[dict[str, Any]]
    figures: list[dict[str, Any]]
    players: list[dict[str, Any]]

    def drives(
        self,
        name: str,
        *,
        until: float,
        samples: int,
        attitude: bool = False,
        charted: str | None = None,
        **start: Any,
    ) -> AskedMotion:
        """Ask for the motion ``name`` from the state and parameters ``start``, at so many ``samples``.

        With ``attitude`` the state is the angular velocity of a body along its axes, and R (n, 3, 3), which
        takes body components to space, follows it from R = 1. ``charted`` names the motion in a chart of
        speed against accuracy.
        """
        made = Motion(name, start, until, samples, attitude, charted=charted)
        self.dynamics.fixed[name] = made
        return AskedMotion(self, (made,))

    def of(self, *names: str) -> AskedMotion:
        """Return motions of this or of earlier exercises, for checks of them together."""
        return AskedMotion(self, tuple(self.dynamics.fixed[name] for name in names))

    def hidden_motion(self, name: str, label: str, draw: JointDraw, *, attitude: bool = False) -> None:
        """Check that a motion that ``draw`` starts anew for each grading, and ends at ``until``, follows the
        exact one: by the values of the function at points along it.
        """
        motion = draw.function.__name__.replace("_", " ")
        self.dynamics.hidden[motion] = HiddenMotion(motion, draw, attitude)
        self.checks.append({"name": name, "label": label, "word": "bounded", "of": [motion], "tolerance": {}})

    def shows(self, name: str, title: str, alt: str, draw: FunctionType, *motions: str) -> None:
        """Add the figure that ``draw(canvas, seen, truth)`` draws of these motions: one dict of arrays for
        each in both lists.
        """
        about = {"name": name, "title": title, "alt": alt}
        self.figures.append(about | {"scenes": list(motions), "draw": self.portable(draw)})

    def portable(self, function: FunctionType) -> str:
        """Return the name of a function in the module that students get. Raises DeclarationError if it is not
        there.
        """
        name = function.__name__
        if self.shown is None or getattr(self.shown, name, None) is not function:
            raise DeclarationError(
                f"{name} must be a function of the module that is given as shown=: students get it too",
                sys._getframe(3).f_lineno,
            )
        return name

    def _driven(self, question: Question, **more: Any) -> Driven:
        """Return a question with what is asked of its motions."""
        given = {one.name: getattr(question, one.name) for one in fields(Question)}
        source = Path(inspect.getfile(self.shown)).read_text(encoding="utf-8") if self.shown else ""
        asked: dict[str, Any] = {"checks": self.checks, "figures": self.figures, "players": self.players}
        return Driven(**given, dynamics=self.dynamics, shown=source, **asked, **more)


@dataclass(eq=False)
class AskedDynamics(Asked, Motions):
    """A right-hand side that an exercise asks for, with the exact motions that it should drive."""

    points: str = field(default="", kw_only=True)
    dynamics: Dynamics = field(default_factory=lambda: Dynamics("t", "y"), kw_only=True)
    terms: dict[str, Function] = field(default_factory=dict, kw_only=True)
    shown: ModuleType | None = field(default=None, kw_only=True)
    checks: list[dict[str, Any]] = field(default_factory=list, kw_only=True)
    figures: list[dict[str, Any]] = field(default_factory=list, kw_only=True)
    players: list[dict[str, Any]] = field(default_factory=list, kw_only=True)

    def exact_motion(self, function: Function) -> Function:
        """Decorate the function that returns the exact state (d, n) at times (n,), or with ``attitude`` a
        pair of it and R (n, 3, 3). It takes the time, the start, and ``attitude`` by name.
        """
        self.dynamics.exact = function
        return function

    def sensitivity(self, function: Function) -> Function:
        """Decorate the function that returns the ``Sensitivity`` of a motion from its start and ``until``."""
        self.dynamics.sensitivity = function
        return function

    def term(self, text: str) -> Callable[[Function], Function]:
        """Decorate the function of all inputs that returns a term, such as friction, that a wrong answer may
        have in addition with any coefficient; ``text`` follows "an extra term".
        """

        def decorate(function: Function) -> Function:
            self.terms[text] = function
            return function

        return decorate

    def questions(self, uses: Sequence[NotebookSolution]) -> list[Question]:
        """Return the question, which plays the motions of all exercises."""
        (question,) = super().questions(uses)
        is_charted = any(motion.charted for motion in self.dynamics.fixed.values())
        question = replace(question, sweep=chart if is_charted else None, terms=self.terms)
        return [self._driven(question, points=self.points)]


@dataclass(eq=False)
class AskedAgain(AskedSolution, Motions):
    """A function of an earlier exercise: its values count here too, and more is asked of its motions."""

    first: AskedDynamics
    role: str | None = None
    checks: list[dict[str, Any]] = field(default_factory=list, kw_only=True)
    figures: list[dict[str, Any]] = field(default_factory=list, kw_only=True)
    players: list[dict[str, Any]] = field(default_factory=list, kw_only=True)

    @property
    def dynamics(self) -> Dynamics:  # type: ignore[override]
        """The motions of all exercises."""
        return self.first.dynamics

    @property
    def shown(self) -> ModuleType | None:  # type: ignore[override]
        """The module that students get."""
        return self.first.shown

    def questions(self, uses: Sequence[NotebookSolution]) -> list[Question]:
        """Return the question with the checks of this exercise."""
        (first,) = self.first.questions(uses)
        asked = replace(first, role=self.role, sweep=None, mistakes=tuple(self.mistakes), line=self.line)
        return [self._driven(asked, points=self.first.points, again=True)]
