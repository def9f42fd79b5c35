"""Questions about one step of an integration method: its values, its order of convergence, and its stability
limit.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from exercises.authoring.assignments.assignment import ArraySpec, Scene, Sweep
from exercises.authoring.assignments.speed_vs_accuracy import BUDGET_S, result_of_steppers
from exercises.authoring.kinds import kind
from exercises.authoring.kinds.ode import converged
from exercises.authoring.questions.author_arguments import (
    Absolute,
    Agree,
    Close,
    Expression,
    Family,
    Given,
    Limit,
    Named,
    Positive,
    Rule,
    Truth,
    named_values,
    tolerance_data,
)
from exercises.authoring.questions.question import Later, Part, Question, call_with
from exercises.authoring.questions.question_errors import family_errors
from exercises.authoring.solutions import NotebookSolution
from polhode.judging.checks import Arrays
from polhode.judging.outcome import SweepResult
from polhode.kinds import stepper as kit
from polhode.kinds.student_calls import arguments, flat


def tableau(A: Sequence[Sequence[float]], b: Sequence[float], c: Sequence[float]) -> Callable[..., Any]:
    """Return ``step(f, t, y, h)`` of the explicit Runge–Kutta method with this Butcher tableau.

    Row i of ``A`` holds the weights of the slopes 0 to i − 1.
    """

    def step(f: Callable[..., Any], t: float, y: Any, h: float) -> Any:
        k: list[Any] = []
        for row, at in zip(A, c, strict=True):
            k.append(
                np.asarray(f(t + at * h, y + h * sum(a * slope for a, slope in zip(row, k, strict=False))))
            )
        return y + h * sum(weight * slope for weight, slope in zip(b, k, strict=True))

    return step


euler = tableau([[]], [1], [0])
midpoint = tableau([[], [1 / 2]], [0, 1], [0, 1 / 2])
heun = tableau([[], [1]], [1 / 2, 1 / 2], [0, 1])
rk4 = tableau([[], [1 / 2], [0, 1 / 2], [0, 0, 1]], [1 / 6, 1 / 3, 1 / 3, 1 / 6], [0, 1 / 2, 1 / 2, 1])


@kind()
def stepper(
    solution: NotebookSolution,
    inputs: Given,
    agree: Agree,
    *,
    truth: Truth | None = None,
    calls: Limit | None = None,
    order: tuple[Positive, Absolute] | None = None,
    rates: Named | None = None,
    stable_to: tuple[Annotated[float, Rule("a number ≥ 0, or math.inf", lambda h: h >= 0)], Close]
    | None = None,
    test: Expression | None = None,
    chart: Positive | None = None,
    time: str = "t",
    step: str = "h",
    state: str = "y",
) -> Question:
    """Return the question for one step, such as ``step(f, t, y, h)`` or ``verlet(force, x, v, h)``.

    The step returns the new ``state``, or several values (``agree``) with the names of the parameters that
    they replace. ``truth`` may be a ``tableau``. ``calls`` limits the calls of the function argument.

    ``order`` is the order of convergence; its tolerance ``atol`` is how far below it the observed order may
    be. It is observed for runs of four steps of each row's size, halved six times, against the integrated
    ``rates``: a function of the arguments that returns the derivatives of the state in order, by default the
    function argument. ``stable_to`` is the largest step for which the ``test`` problem does not grow, 0 if it
    always grows, or ``math.inf``. The test problem is the expression of the function argument, by default
    minus its last variable: y' = −y, or x'' = −x.

    ``chart`` adds the step to the chart of speed against accuracy: the time that a motion from the first
    row's state takes. All steppers of the assignment with ``chart`` are in one chart.
    """
    several = named_values(agree)
    name, family = next(
        ((name, value) for name, value in inputs.items() if isinstance(value, Family)),
        ("", Family("0", ("",), {})),
    )
    states = {value: value for value in several} if isinstance(agree, Mapping) else {"value": state}
    data: dict[str, Any] = {
        "time": time,
        "step": step,
        "state": states,
        "test": test or f"-{family.over[-1]}",
    }
    measured = {"order": order, "stability": stable_to}
    data |= {"chart": chart} if chart else {}
    data |= {
        part: [min(given[0], kit.LARGEST), tolerance_data(given[1])]
        for part, given in measured.items()
        if given
    }

    def exact(values: Mapping[str, Any], elapsed: NDArray[np.float64]) -> NDArray[np.float64]:
        def derivatives(at: Mapping[str, Any]) -> Any:
            return call_with(rates, at) if rates else at[name](*(at[variable] for variable in family.over))

        return converged(derivatives, values, list(states.values()), time, values.get(time, 0.0) + elapsed)

    def ends(values: Mapping[str, Any]) -> dict[str, Any]:
        return {"ends": exact(values, values[step] * np.arange(kit.FIRST + 1))[:, 1:].T}

    def end(values: Mapping[str, Any]) -> dict[str, Any]:
        return {"end": exact(values, np.array([0.0, data["chart"]]))[:, 1]}

    def errors() -> Iterator[str]:
        if not name:
            yield "a step needs a function argument: expression(…)"
            return
        if (order or chart) and rates is None and len(states) > 1:
            left = ", ".join(states.values())
            yield (
                f"order and chart need the derivatives of {left}: decorate with @question.rates a function"
                " that returns them in order, such as v, acc(x)"
            )
        yield from (
            f"it has no parameter {given}" for given in [step, *states.values()] if given not in inputs
        )
        yield from (
            f"the test problem: {error}" for error in family_errors(Family(data["test"], family.over, {}))
        )

    parts = {"order": Part(ends), "stability": Part(lambda values: {}, 1)}
    return Question(
        kind="stepper",
        solution=solution,
        inputs=inputs,
        values=several,
        truth=truth,
        data=data | ({"calls": tolerance_data(calls)} if calls else {}),
        parts={part: parts[part] for part, given in measured.items() if given},
        sweep=_Chart(Part(end)) if chart else None,
        errors=errors,
    )


@dataclass(frozen=True)
class _Chart:
    """The chart of speed against accuracy of steppers; ``end`` has the exact state at the end of one
    stepper's motion.
    """

    end: Part

    def __call__(self, questions: Sequence[Question]) -> Sweep:
        """Return the chart of all these steppers, each from the first row of its question."""
        first, names = questions[0], [question.function for question in questions]
        title = f"{', '.join(names)} to {first.data['time']} = {first.data['chart']:g}"

        def row_of(question: Question) -> dict[str, Any]:
            return question.draw(np.random.default_rng(0), 1)

        def method(question: Question) -> dict[str, Any]:
            row = {name: value[0].tolist() for name, value in row_of(question).items()}
            return {**question.asked, "constants": question.asked["constants"] | row}

        def returns() -> dict[str, ArraySpec]:
            states = [flat(list(q.data["state"].values()), arguments(method(q), {})) for q in questions]
            made = {
                f"end_{k}": ArraySpec((1, len(kit.CHARTED), state.size)) for k, state in enumerate(states)
            }
            return made | {
                name: ArraySpec((1, len(questions), len(kit.CHARTED))) for name in ("calls", "seconds")
            }

        def truth(inputs: Mapping[str, Any]) -> Arrays:
            ends = [
                (question, question.sweep.end) for question in questions if isinstance(question.sweep, _Chart)
            ]
            return {
                f"end_{k}": question.exact(row_of(question), end)["end"]
                for k, (question, end) in enumerate(ends)
            }

        def read(seen: Arrays, exact: Arrays) -> SweepResult:
            pairs = [(seen[f"end_{k}"][0], exact[f"end_{k}"][0]) for k in range(len(questions))]
            with np.errstate(all="ignore"):
                errors = np.array(
                    [np.abs(got - want).max(axis=-1) / np.abs(want).max() for got, want in pairs]
                )
            steps = np.array([q.data["chart"] for q in questions])[:, None] / kit.CHARTED
            return result_of_steppers(
                title, names, steps, errors, {name: seen[name][0] for name in ("calls", "seconds")}
            )

        asked = Later(
            lambda: {
                "kind": first.kind,
                "part": "sweep",
                "methods": [method(question) for question in questions],
            }
        )
        scene = Scene(
            f"{first.id}-sweep", "play", first.function, {}, Later(returns), truth, BUDGET_S, question=asked
        )
        return Sweep(scene, read)
