"""Kinds of questions: how each is asked and judged, from data alone.

A question is a JSON document that an author's declaration produces: its ``kind``, the student's
``function``, its ``parameters`` and constant arguments, the values it ``returns``, and what the checks of
its kind need. The module of a kind has ``play(question, student, rows)``, which asks the question once for
each row of drawn arguments, and ``checks(question, scene, suffix)``. A question with ``parts`` has a further
public scene for each of them, with the part's name as ``question["part"]``: ``PARTS[part](question, student,
row)`` returns the arrays of one row, and ``part_checks(question, scene)`` its checks. Parts of a question
with a ``points_scene`` are motions (``motions``), which checks of several exercises may read. The sandbox,
the server and ``polhode.check`` use the same functions.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from types import ModuleType
from typing import Any

import numpy as np

from polhode.judging.checks import Arrays, Check
from polhode.judging.exercise import Exercise
from polhode.judging.outcome import Diagnosis
from polhode.judging.verdict import Verdict
from polhode.kinds import animation, expression, fit, motions, ode, random, stepper, values, variables
from polhode.kinds.animation import animation_of_cell
from polhode.kinds.student_calls import each
from polhode.kinds.values import agreement, finite_alike, own_scale, to_rounding

KINDS: Mapping[str, ModuleType] = {
    "animation": animation,
    "expression": expression,
    "fit": fit,
    "ode": ode,
    "random": random,
    "stepper": stepper,
    "values": values,
    "variables": variables,
}
NEW_INPUTS = " (new inputs)"  # ends the label of a check with random inputs


def kind_module(question: Mapping[str, Any]) -> ModuleType:
    """Return the module of a question's kind."""
    return KINDS[question["kind"]]


def play(question: Mapping[str, Any], student: Mapping[str, Any], rows: Mapping[str, Any]) -> dict[str, Any]:
    """Ask the question for every row and return the arrays by name, rows along the first index. Raises
    WrongAnswer.
    """
    module, part = kind_module(question), question.get("part")
    if part and "points_scene" in question:
        return motions.play(question, student, rows)
    answers: dict[str, Any] = (
        each(rows, lambda row: module.PARTS[part](question, student, row))
        if part
        else module.play(question, student, rows)
    )
    return answers


def adopt(
    questions: Iterable[Mapping[str, Any] | None], student: Mapping[str, Any], source: str
) -> dict[str, Any]:
    """Return functions that stand for the animation that the cell ``source`` shows, for the questions that
    accept one.
    """
    names = {
        q["function"]: None
        for q in questions
        if q and q["kind"] == "animation" and (q["body"] or {}).get("L")
    }
    return {
        name: made
        for function in names
        for name, made in animation_of_cell.adopt(function, student, source).items()
    }


def question_checks(question: Mapping[str, Any], scene: str, hidden: bool) -> list[Check]:
    """Return the checks of a question for one of its scenes."""
    module, again = kind_module(question), hidden and question["scenes"]["public"] is not None
    asked = {**question, "id": f"{question['id']}-new"} if again else question
    found: list[Check] = (
        module.part_checks(asked, scene)
        if question.get("part")
        else module.checks(asked, scene, NEW_INPUTS if again else "")
    )
    return found


def diagnose(question: Mapping[str, Any], seen: Arrays, truth: Arrays) -> list[Diagnosis] | None:
    """Return the likely cause behind a scene's arrays, or None if the kind finds causes by reproducing
    them.
    """
    return _if_defined("diagnose", question, seen, truth)


def reproduces(
    question: Mapping[str, Any], seen: Arrays, predicted: Arrays, truth: Arrays | None = None
) -> bool:
    """Return whether a scene's arrays are the ``predicted`` ones: values to their tolerance, statistics of
    random numbers to rounding, others exactly.

    ``truth`` holds the scales of values that have their own.
    """
    values = {value["name"]: to_rounding(value) for value in question["returns"]}
    return all(
        (
            agreement(
                values[name], *finite_alike(seen[name], array), own_scale(values[name], array, truth or {})
            ).verdict
            is Verdict.PASS
            if name in values
            else np.array_equal(seen[name], array)
        )
        for name, array in predicted.items()
    )


def _if_defined(name: str, question: Mapping[str, Any], *arguments: Any) -> Any:
    """Return what this function of the question's kind returns, None if the kind has no such function."""
    function = getattr(kind_module(question), name, None)
    return function(question, *arguments) if function else None


def exercise(number: str, title: str, questions: Iterable[Mapping[str, Any]], hidden: bool) -> Exercise:
    """Return an exercise of these questions with the checks of its public scenes, and of its hidden ones if
    ``hidden``.
    """
    asked, checks = list(questions), list[Check]()
    for q in asked:
        parts = [({**q, "part": part}, f"{q['id']}-{part}") for part in q.get("parts", ())]
        for question, scene in [(q, q["scenes"]["public"]), *parts]:
            checks += question_checks(question, scene, False) if scene else []
        checks += motions.checks(q, along=hidden) if "motions" in q else []
    for q in asked if hidden else ():
        checks += question_checks(q, q["scenes"]["hidden"], True) if q["scenes"]["hidden"] else []
        checks += motions.hidden_checks(q) if "motions" in q else []
    points = {id: given for q in asked for id, given in q.get("points", {}).items()}
    checks = [replace(check, points=points.get(check.id, check.points)) for check in checks]
    figures = [f for q in asked for f in [*(_if_defined("figures", q) or ()), *motions.figures(q)]]
    sheets = [sheet for q in asked for sheet in _if_defined("animations", q) or ()]

    def names(role: str | None) -> tuple[str, ...]:
        own = [q["variables"] or [q["function"]] for q in asked if q.get("role") == role]
        return tuple(dict.fromkeys(name for each in own for name in each))

    return Exercise(
        number,
        title,
        names(None),
        tuple(checks),
        tuple(figures),
        tuple(sheets),
        optional=names("optional"),
        motions=tuple(player for q in asked for player in motions.players(q)),
        variables=tuple(dict.fromkeys(name for q in asked for name in q["variables"])),
        prerequisites=names("prerequisite"),
    )
