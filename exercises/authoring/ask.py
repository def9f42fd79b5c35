"""What an exercise function is called with: a method for each kind of question."""

import sys
from collections.abc import Callable, Mapping, Sequence
from types import ModuleType
from typing import Any

from exercises.authoring.asked_cell import AskedCell
from exercises.authoring.asked_motions import AskedAgain, AskedDynamics
from exercises.authoring.asked_solution import Asked, DeclarationError
from exercises.authoring.draws import JointDraw, between
from exercises.authoring.importing.reported_lines import Line
from exercises.authoring.kinds.animation import animation, body_animation
from exercises.authoring.kinds.expression import expression
from exercises.authoring.kinds.fit import fit
from exercises.authoring.kinds.ode import ode
from exercises.authoring.kinds.random import estimate, samples
from exercises.authoring.kinds.stepper import stepper
from exercises.authoring.kinds.values import values
from exercises.authoring.questions.author_arguments import Value
from exercises.authoring.questions.question import Question
from exercises.authoring.solutions import NoSolution, NotebookSolution, Solutions
from polhode.judging.outcome import Tolerance

Function = Callable[..., Any]


class Ask:
    """Asks for solutions of the notebook, each by its name. ``partial`` gives the points of a ✗ in part.

    Every method takes ``inputs``, a joint draw for the parameters; other inputs are those of cases. ``share``
    is the question's share of the exercise's points. ``label`` stands for "NAME is right" in the labels of
    checks, or for NAME in those of random output. ``mistakes_of`` is an earlier question about the same
    solution, whose mistakes are mistakes of this one too. All calls for one scene may take ``budget_s`` of
    CPU time.
    """

    def __init__(
        self, solutions: Solutions, partial: bool, earlier: dict[str, AskedDynamics] | None = None
    ) -> None:
        self._solutions, self._partial = solutions, partial
        self._earlier: dict[str, AskedDynamics] = {} if earlier is None else earlier
        self.asked: list[Asked | AskedCell | AskedAgain] = []
        self.lines: list[Line] = []

    def function(
        self,
        name: str,
        inputs: JointDraw | None = None,
        *,
        returns: str | Sequence[str] = "",
        keys: bool = False,
        calls: Tolerance | None = None,
        optional: bool = False,
        label: str | None = None,
        mistakes_of: Asked | None = None,
        share: float = 1.0,
        budget_s: float = 5.0,
    ) -> Asked:
        """Ask for the values that a function or class returns.

        ``returns`` names the values of a returned tuple in order, or with ``keys`` those of a dict. ``calls``
        limits the calls of the function arguments. The checks of a function that is ``optional`` are left out
        if it is not written; their points are a bonus.
        """
        asked = self._asked(
            values,
            name,
            inputs,
            _names(returns),
            share,
            calls=calls,
            keys=keys,
            budget_s=budget_s,
            label=label,
            alike=mistakes_of,
        )
        asked.role = "optional" if optional else None
        return asked

    def dynamics(
        self,
        name: str,
        inputs: JointDraw,
        *,
        returns: str,
        state: str = "y",
        time: str = "t",
        shown: ModuleType | None = None,
        points: str | None = None,
        share: float = 1.0,
        budget_s: float = 5.0,
    ) -> AskedDynamics:
        """Ask for the right-hand side of a differential equation: its values, which ``returns`` names, at the
        points ``inputs`` and along exact motions, and the motions that it drives, which this and later
        exercises declare.

        ``shown`` is a module beside the declaration, with the functions that checks measure and figures draw
        with; students get it too, so it imports only numpy and the kit. ``points`` is the name of the scene
        of all points.
        """
        line = sys._getframe(1).f_lineno
        asked = AskedDynamics(
            self._found(self._solutions.function, name, line),
            line,
            share,
            ode,
            {"time": time, "state": state, "budget_s": budget_s},
            inputs,
            (returns,),
            self._partial,
            points=points or f"points of {name}",
            shown=shown,
        )
        asked.dynamics.time, asked.dynamics.state = time, state
        self._earlier[name] = asked
        self.asked.append(asked)
        return asked

    def again(self, name: str, *, prerequisite: bool = False, share: float = 1.0) -> AskedAgain:
        """Ask for the right-hand side of an earlier exercise once more: its values count here too. Work on a
        ``prerequisite`` alone is no attempt at this exercise.
        """
        line = sys._getframe(1).f_lineno
        if name not in self._earlier:
            raise DeclarationError(f"no earlier exercise asks for the dynamics {name}", line)
        first, role = self._earlier[name], "prerequisite" if prerequisite else None
        asked = AskedAgain(first.solution, line, share, first, role)
        self.asked.append(asked)
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
    ) -> Asked:
        """Ask for the right-hand side of an ordinary differential equation: its values at points, and with
        ``until`` its motion to that time, which agrees with the exact one to ``follow``.

        ``conserved`` maps names to an expression over state, time and parameters, and the greatest relative
        drift. ``scale`` is the typical size of the state. The time of the points is drawn unless a case
        gives it.
        """
        asked = self._asked(
            ode,
            name,
            inputs,
            (),
            share,
            until=until,
            follow=follow,
            conserved=conserved,
            time=time,
            state=state,
            scale=scale,
            most_calls=most_calls,
            budget_s=budget_s,
        )
        asked.defaults = {time: between(0.0, until or 1.0)}
        return asked

    def step(
        self,
        name: str,
        inputs: JointDraw | None = None,
        *,
        state: str | Sequence[str],
        order: tuple[float, Tolerance] | None = None,
        stable_to: tuple[float, Tolerance] | None = None,
        calls: Tolerance | None = None,
        test: str | None = None,
        chart: float | None = None,
        time: str = "t",
        step: str = "h",
        share: float = 1.0,
        budget_s: float = 5.0,
    ) -> Asked:
        """Ask for one step of an integration method, which returns the new ``state``, such as "x v".

        ``order`` is the order of convergence and how far below it the observed one may be, ``stable_to`` the
        largest step for which the ``test`` problem does not grow. ``chart`` adds the step to the chart of
        speed against accuracy: the time that a motion takes. Numbers come with their tolerance.
        """
        states = _names(state)
        return self._asked(
            stepper,
            name,
            inputs,
            states if len(states) > 1 else (),
            share,
            calls=calls,
            order=order,
            stable_to=stable_to,
            test=test,
            chart=chart,
            time=time,
            step=step,
            state=states[0],
            budget_s=budget_s,
        )

    def samples(
        self,
        name: str,
        distribution: str,
        inputs: JointDraw | None = None,
        *,
        parameters: Mapping[str, Function | float] | None = None,
        repetitions: int = 20,
        label: str | None = None,
        mistakes_of: Asked | None = None,
        share: float = 1.0,
        budget_s: float = 20.0,
    ) -> Asked:
        """Ask for independent samples of a ``distribution`` of scipy.stats with these ``parameters``:
        numbers, or functions of the inputs. Each input is asked ``repetitions`` times.
        """
        return self._asked(
            samples,
            name,
            inputs,
            None,
            share,
            distribution=distribution,
            repetitions=repetitions,
            budget_s=budget_s,
            **(parameters or {}),
            label=label,
            alike=mistakes_of,
        )

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
        label: str | None = None,
        mistakes_of: Asked | None = None,
        share: float = 1.0,
        budget_s: float = 20.0,
    ) -> Asked:
        """Ask for an estimate whose expected value is the truth, nearly normally distributed with the
        standard deviation ``sd``, a number or a function of the inputs.

        Mean and spread of the ``repetitions`` are tested against both. With ``error`` the function returns an
        estimate and its error: the root mean square of error/sd - 1 is at most the limit of that tolerance,
        for N samples in an estimate at least 5/√N. ``mean_error`` limits the relative deviation of the mean
        of all returned errors from sd. ``bias`` is a systematic error that is allowed.
        """
        return self._asked(
            estimate,
            name,
            inputs,
            None,
            share,
            sd=sd,
            error=error,
            mean_error=mean_error,
            bias=bias,
            repetitions=repetitions,
            budget_s=budget_s,
            label=label,
            alike=mistakes_of,
        )

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
        """Ask for a fit of ``model``, called with ``x`` and parameters, to data with normal noise ``sigma``.

        The parameters of the data are ``drawn``, by their names in the model. The tolerances of the fitted
        ``parameters`` and of their ``covariance`` are relative to the standard deviations of the parameters.
        ``absolute_sigma`` is that of ``scipy.optimize.curve_fit``.
        """
        return self._asked(
            fit,
            name,
            None,
            None,
            share,
            model=model,
            x=x,
            sigma=sigma,
            drawn=drawn,
            parameters=parameters,
            covariance=covariance,
            absolute_sigma=absolute_sigma,
            budget_s=budget_s,
        )

    def symbolic(
        self,
        name: str,
        inputs: JointDraw | None = None,
        *,
        returns: str | Sequence[str] = "",
        label: str | None = None,
        mistakes_of: Asked | None = None,
        share: float = 1.0,
    ) -> Asked:
        """Ask for a sympy expression, or a matrix or tuple of them, that a function returns; or for one that
        a cell assigns to the variable ``name``, whose symbols are known by their names.

        Its inputs are symbols (``symbol``), constants and draws. The truth gets numbers for the symbols.
        """
        is_variable = self._solutions.is_variable(name)
        return self._asked(
            expression,
            name,
            inputs,
            _names(returns),
            share,
            label=label,
            alike=mistakes_of,
            **({"variable": name} if is_variable else {}),
        )

    def animation(
        self,
        name: str,
        inputs: JointDraw | None = None,
        *,
        follows: str | Sequence[str],
        agree: Tolerance,
        time: str = "t",
        share: float = 1.0,
    ) -> Asked:
        """Ask for an animation in which something drawn follows the trajectories ``follows``, arguments (n,
        2) or (n, 3) at the times ``time``. ``agree`` is the greatest deviation, relative to the extent.
        """
        return self._asked(
            animation,
            name,
            inputs,
            None,
            share,
            follow=list(_names(follows)),
            agree=agree,
            time=time,
        )

    def body_animation(
        self,
        name: str,
        *,
        attitude: str = "R",
        momentum: str | None = None,
        box: str | None = None,
        axis: int | None = None,
        moments: Sequence[float] = (),
        title: str | None = None,
        sheet: str | None = None,
        scene: str | None = None,
        time: str = "t",
        optional: bool = False,
        share: float = 1.0,
        **given: Any,
    ) -> Asked:
        """Ask for an animation of a turning body in any style, from the arguments ``given``: times, the
        ``attitude``, and the angular ``momentum`` in space or the half edges of a ``box``, by their names.

        Something drawn must follow the body ``axis``, or for None any points of the body, and what is drawn
        along L must stay. An animation of a symmetric top that a cell shows is accepted in place of the
        function: its ``moments`` are among the notebook's numbers, or are these. ``title`` and ``sheet`` are
        those of the contact sheet, ``scene`` is the scene's name.
        """
        asked = self._asked(
            body_animation,
            name,
            None,
            None,
            share,
            body={"R": attitude, "L": momentum, "half": box, "axis": axis},
            time=time,
            moments=moments,
            title=title,
            sheet=sheet,
            scene=scene,
        )
        asked.role = "optional" if optional else None
        asked.case("", **given)
        return asked

    def cell(
        self, variables: str | Sequence[str], *, given: str | Sequence[str] = "", share: float = 1.0
    ) -> AskedCell:
        """Ask for the ``variables`` that a solution cell assigns. ``given`` are constants of the notebook,
        which the truths take.
        """
        line = sys._getframe(1).f_lineno
        names = _names(variables)
        asked = AskedCell(self._found(self._solutions.cell, names, line), line, share, names, _names(given))
        self.asked.append(asked)
        return asked

    def line(
        self,
        label: str,
        *,
        truth: Any = None,
        trust: bool = False,
        points: int = 1,
        shown: bool = False,
        accept: bool = False,
        given: bool = False,
    ) -> None:
        """Take over a line that a validation cell of the notebook prints, by its ``label`` as the cell writes
        it; the expressions of an f-string stay in braces.

        The line carries no ``points`` until ``truth`` is the exact value, or a function without parameters
        that computes it, with which ``validate.close`` then compares; or until ``trust=True`` accepts what
        the student's code reports. With ``shown`` the truth stands in the students' notebook, and the line
        counts if you ``accept`` that. A ``given`` line is ✓ without any student's code and cannot count.
        """
        line = sys._getframe(1).f_lineno
        self.lines.append(Line(label, truth, trust, points, line, shown, accept, given))

    def _asked(
        self,
        kind: Callable[..., Question],
        name: str,
        inputs: JointDraw | None,
        returned: tuple[str, ...] | None,
        share: float,
        *,
        label: str | None = None,
        alike: Asked | None = None,
        **options: Any,
    ) -> Asked:
        """Return a new question of a ``kind`` about the solution ``name``, asked two frames above.

        ``returned`` are the names of its values, None if the question has no tolerances of values.
        ``options`` are arguments of the kind that do not depend on the case.
        """
        line = sys._getframe(2).f_lineno
        if "variable" in options:
            solution = self._found(self._solutions.cell, (name,), line)
        else:
            solution = self._found(self._solutions.function, name, line)
        asked = Asked(solution, line, share, kind, options, inputs, returned, self._partial, label, alike)
        self.asked.append(asked)
        return asked

    def _found(self, find: Callable[[Any], NotebookSolution], name: Any, line: int) -> NotebookSolution:
        try:
            return find(name)
        except NoSolution as error:
            raise DeclarationError(str(error), line) from None


def _names(given: str | Sequence[str]) -> tuple[str, ...]:
    """Return the names in a text such as "a e omega", or in a sequence."""
    return tuple(given.split()) if isinstance(given, str) else tuple(given)
