"""What an exercise function is called with: a method for each kind of question."""

import sys
from collections.abc import Callable, Mapping
from typing import Any

from ecp.outcome import Tolerance
from exercises.authoring.asked import Asked, Case, DeclarationError, RightHandSide, Step
from exercises.authoring.asked_cell import AskedCell
from exercises.authoring.draws import JointDraw, between
from exercises.authoring.solutions import NoSolution, NotebookSolution, Solutions
from exercises.declared import Value
from exercises.kinds.animation import animation
from exercises.kinds.expression import expression
from exercises.kinds.fit import fit
from exercises.kinds.ode import ode
from exercises.kinds.random import estimate, samples
from exercises.kinds.stepper import stepper
from exercises.kinds.values import values
from exercises.question import Question

Function = Callable[..., Any]


class Ask:
    """Asks for solutions of the notebook, each by its name. ``partial`` gives the points of a ✗ in part.

    Every method takes ``inputs``, a joint draw for the parameters; other inputs are those of cases. ``share``
    is the question's share of the exercise's points.
    """

    def __init__(self, solutions: Solutions, partial: bool) -> None:
        self._solutions, self._partial = solutions, partial
        self.asked: list[Asked | AskedCell] = []

    def function(
        self,
        name: str,
        inputs: JointDraw | None = None,
        *,
        returns: str = "",
        keys: bool = False,
        calls: Tolerance | None = None,
        share: float = 1.0,
        budget_s: float = 5.0,
    ) -> Asked:
        """Ask for the values that a function or class returns.

        ``returns`` names the values of a returned tuple in order, or with ``keys`` those of a dict. ``calls``
        limits the calls of the function arguments.
        """

        def make(inputs: dict[str, Any], agree: Any, truth: Any, case: Case, uses: list[Any]) -> Question:
            return values(
                asked.solution,
                inputs,
                agree,
                truth=truth,
                calls=calls,
                call=case.call,
                keys=keys,
                rows=case.rows,
                uses=uses,
                budget_s=budget_s,
            )

        asked = self._asked(name, make, inputs, tuple(returns.split()), share)
        return asked

    def right_hand_side(
        self,
        name: str,
        inputs: JointDraw | None = None,
        *,
        until: float | None = None,
        follow: Tolerance | None = None,
        conserved: Mapping[str, tuple[str, Tolerance]] | None = None,
        scale: float | tuple[float, ...] = 1.0,
        time: str = "t",
        state: str = "y",
        most_calls: int = 20_000,
        share: float = 1.0,
        budget_s: float = 5.0,
    ) -> RightHandSide:
        """Ask for the right-hand side of an ordinary differential equation: its values at points, and with
        ``until`` its motion to that time, which agrees with the exact one to ``follow``.

        ``conserved`` maps names to an expression over state, time and parameters, and the greatest relative
        drift. ``scale`` is the typical size of the state. The time of the points is drawn unless a case
        gives it.
        """

        def make(inputs: dict[str, Any], agree: Any, truth: Any, case: Case, uses: list[Any]) -> Question:
            return ode(
                asked.solution,
                inputs,
                agree,
                truth=truth,
                t_end=until,
                follow=follow,
                motion=asked.closed_form,
                conserved=conserved,
                time=time,
                state=state,
                scale=scale,
                most_calls=most_calls,
                rows=case.rows,
                uses=uses,
                budget_s=budget_s,
            )

        asked = self._asked(name, make, inputs, (), share, kind=RightHandSide)
        asked.defaults = {time: between(0.0, until or 1.0)}
        return asked

    def step(
        self,
        name: str,
        inputs: JointDraw | None = None,
        *,
        state: str,
        order: tuple[float, Tolerance] | None = None,
        stable_to: tuple[float, Tolerance] | None = None,
        calls: Tolerance | None = None,
        test: str | None = None,
        chart: float | None = None,
        time: str = "t",
        step: str = "h",
        share: float = 1.0,
        budget_s: float = 5.0,
    ) -> Step:
        """Ask for one step of an integration method, which returns the new ``state``, such as "x v".

        ``order`` is the order of convergence and how far below it the observed one may be, ``stable_to`` the
        largest step for which the ``test`` problem does not grow. ``chart`` adds the step to the chart of
        speed against accuracy: the time that a motion takes. Numbers come with their tolerance.
        """
        states = tuple(state.split())

        def make(inputs: dict[str, Any], agree: Any, truth: Any, case: Case, uses: list[Any]) -> Question:
            return stepper(
                asked.solution,
                inputs,
                agree,
                truth=truth,
                calls=calls,
                order=order,
                rates=asked.derivatives,
                stability=stable_to,
                test=test,
                chart=chart,
                time=time,
                step=step,
                state=states[0],
                rows=case.rows,
                uses=uses,
                budget_s=budget_s,
            )

        asked = self._asked(name, make, inputs, states if len(states) > 1 else (), share, kind=Step)
        return asked

    def samples(
        self,
        name: str,
        distribution: str,
        inputs: JointDraw | None = None,
        *,
        parameters: Mapping[str, Function | float] | None = None,
        repetitions: int = 20,
        share: float = 1.0,
        budget_s: float = 20.0,
    ) -> Asked:
        """Ask for independent samples of a ``distribution`` of scipy.stats with these ``parameters``:
        numbers, or functions of the inputs. Each input is asked ``repetitions`` times.
        """

        def make(inputs: dict[str, Any], case: Case, uses: list[Any], **_: Any) -> Question:
            return samples(
                asked.solution,
                inputs,
                distribution,
                call=case.call,
                repetitions=repetitions,
                label=" for ".join(filter(None, (name, case.name))),
                rows=case.rows,
                uses=uses,
                budget_s=budget_s,
                **(parameters or {}),
            )

        asked = self._asked(name, make, inputs, None, share)
        return asked

    def estimate(
        self,
        name: str,
        inputs: JointDraw | None = None,
        *,
        sd: Function | float,
        error: Tolerance | None = None,
        mean_error: Tolerance | None = None,
        bias: Tolerance | None = None,
        repetitions: int = 400,
        share: float = 1.0,
        budget_s: float = 20.0,
    ) -> Asked:
        """Ask for an estimate whose expected value is the truth, nearly normally distributed with the
        standard deviation ``sd``, a number or a function of the inputs.

        ``error``, ``mean_error`` and ``bias`` are those of ``exercises.kinds.random.estimate``.
        """

        def make(inputs: dict[str, Any], truth: Any, case: Case, uses: list[Any], **_: Any) -> Question:
            return estimate(
                asked.solution,
                inputs,
                truth,
                sd=sd,
                error=error,
                mean_error=mean_error,
                bias=bias,
                call=case.call,
                repetitions=repetitions,
                label=" for ".join(filter(None, (name, case.name))),
                rows=case.rows,
                uses=uses,
                budget_s=budget_s,
            )

        asked = self._asked(name, make, inputs, None, share)
        return asked

    def fit(
        self,
        name: str,
        model: Function,
        *,
        x: Any,
        sigma: Any,
        drawn: Mapping[str, Function],
        parameters: Tolerance | Value,
        covariance: Tolerance | Value,
        absolute_sigma: bool = True,
        share: float = 1.0,
        budget_s: float = 10.0,
    ) -> Asked:
        """Ask for a fit of ``model(x, *parameters)`` to data with normal noise ``sigma``: its parameters and
        their covariance, whose tolerances are relative to the standard deviations of the parameters.
        """

        def make(uses: list[Any], **_: Any) -> Question:
            return fit(
                asked.solution,
                model,
                x=x,
                sigma=sigma,
                drawn=drawn,
                agree=(parameters, covariance),
                absolute_sigma=absolute_sigma,
                uses=uses,
                budget_s=budget_s,
            )

        asked = self._asked(name, make, None, None, share)
        return asked

    def symbolic(
        self, name: str, inputs: JointDraw | None = None, *, returns: str = "", share: float = 1.0
    ) -> Asked:
        """Ask for a sympy expression, or a matrix or tuple of them, that a function returns.

        Its inputs are symbols (``exercises.kinds.expression.symbol``), constants and draws. The truth gets
        numbers for the symbols.
        """

        def make(inputs: dict[str, Any], agree: Any, truth: Any, case: Case, **_: Any) -> Question:
            return expression(asked.solution, inputs, truth, agree=agree, rows=case.rows)

        asked = self._asked(name, make, inputs, tuple(returns.split()), share)
        return asked

    def animation(
        self,
        name: str,
        inputs: JointDraw | None = None,
        *,
        follows: str,
        agree: Tolerance,
        time: str = "t",
        share: float = 1.0,
    ) -> Asked:
        """Ask for an animation in which something drawn follows the trajectories ``follows``, arguments (n,
        2) or (n, 3) at the times ``time``. ``agree`` is the greatest deviation, relative to the extent.
        """

        def make(inputs: dict[str, Any], **_: Any) -> Question:
            return animation(asked.solution, inputs, follows.split(), agree, time=time)

        asked = self._asked(name, make, inputs, None, share)
        return asked

    def cell(self, variables: str, *, given: str = "", share: float = 1.0) -> AskedCell:
        """Ask for variables that a solution cell assigns. ``given`` are constants of the notebook that the
        truths take.
        """
        line = sys._getframe(1).f_lineno
        names = tuple(variables.split())
        asked = AskedCell(
            self._found(self._solutions.cell, names, line), line, share, names, tuple(given.split())
        )
        self.asked.append(asked)
        return asked

    def _asked(
        self,
        name: str,
        make: Callable[..., Question],
        inputs: JointDraw | None,
        returned: tuple[str, ...] | None,
        share: float,
        *,
        kind: type[Any] = Asked,
    ) -> Any:
        """Return a new question about the solution ``name``, asked two frames above.

        ``returned`` are the names of its values, None if the question has no tolerances of values.
        """
        line = sys._getframe(2).f_lineno
        solution = self._found(self._solutions.function, name, line)
        asked = kind(solution, line, share, make, inputs, returned, self._partial)
        self.asked.append(asked)
        return asked

    def _found(self, find: Callable[[Any], NotebookSolution], name: Any, line: int) -> NotebookSolution:
        try:
            return find(name)
        except NoSolution as error:
            raise DeclarationError(str(error), line) from None
