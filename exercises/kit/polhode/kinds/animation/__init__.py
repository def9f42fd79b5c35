"""The kind "animation": an animation of points that follow given trajectories, drawn in any style.

The trajectories are arguments of the student's function: arrays (n, 2) or (n, 3), at times (n,). Each must be
the path of something drawn, such as a marker, the end of a line or the centre of a circle, in 2-D or 3-D
axes. All of them share one scale and one origin in their axes; the frames show the whole motion evenly.

Instead of trajectories a question may have a ``body``: the names of the arguments R, an attitude (n, 3, 3),
and L, the angular momentum, or half, the half edges of a box, and the number of the body ``axis`` to draw.
Then ``polhode.kinds.animation.body`` compares.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from polhode.animation.animation_recording import record
from polhode.judging import comparisons
from polhode.judging.checks import Arrays, Check
from polhode.judging.exercise import Animation
from polhode.judging.outcome import Diagnosis, Tolerance
from polhode.judging.return_value import check_signature
from polhode.judging.verdict import Judgement, Verdict
from polhode.kinds.animation.animation_of_cell import NOT_OWN, FromCell
from polhode.kinds.student_calls import arguments, call, each_row

SMALL = 0.0  # share of the pixels that must change: a point may be as small as one of them


def play(question: Mapping[str, Any], student: Mapping[str, Any], rows: Mapping[str, Any]) -> dict[str, Any]:
    """Return the recording of the animation that the student's function draws from the arguments of the first
    row.
    """
    given = arguments(question, next(each_row(rows), {}))
    if not question["body"]:
        return record(lambda: call(question, student, given), question["seconds"])
    function = student[question["function"]]
    check_signature(function, tuple(given), question["function"])
    own = function.own if isinstance(function, FromCell) else NOT_OWN
    return {**record(lambda: function(*given.values()), question["seconds"]), **own}


def checks(question: Mapping[str, Any], scene: str, suffix: str) -> list[Check]:
    """Return the check that the picture moves, and one for each trajectory."""
    from polhode.kinds.animation.visibility import moves

    id, function = question["id"], question["function"]
    if question["body"]:
        return _of_body(question, scene)
    found = [moves(f"{id}-moves", f"{function} draws a moving picture{suffix}", scene, SMALL)]
    return found + [_follows(question, name, scene, f"{id}-{name}", suffix) for name in question["follow"]]


def animations(question: Mapping[str, Any]) -> list[Animation]:
    """Return the contact sheet of the student's animation."""
    alt = "Contact sheet: stills of the submitted animation in reading order, evenly spaced over its frames."
    scene, title = question["scenes"]["public"], question["title"] or f"by {question['function']}"
    return [Animation(question["sheet"] or scene, f"Your animation {title}", alt, scene)]


def diagnose(question: Mapping[str, Any], seen: Arrays, truth: Arrays) -> list[Diagnosis]:
    """Return why the picture does not move, or what the first trajectory that nothing follows is drawn as
    instead.
    """
    from polhode.kinds.animation.visibility import standstill

    if question["body"]:
        from polhode.kinds.animation.body import diagnose

        return diagnose(seen, _body(question, truth))
    if sentence := standstill(seen, SMALL):
        return [Diagnosis("static", sentence, 1.0)]
    wrong = [shown for shown in _followed(question, seen, truth).values() if not shown.found and shown.code]
    return [Diagnosis(wrong[0].code, wrong[0].sentence, 1.0)] if wrong and wrong[0].code else []


def _of_body(question: Mapping[str, Any], scene: str) -> list[Check]:
    """Return the checks that the picture moves, that something drawn follows the body, and that what is drawn
    along L stays.
    """
    from polhode.kinds.animation.body import follows, keeps_momentum
    from polhode.kinds.animation.body.body_motion import NAMES
    from polhode.kinds.animation.visibility import moves

    id, function, axis = question["number"], question["function"], question["body"]["axis"]
    what = "the body" if axis is None else f"the body axis {NAMES[axis]}(t)"
    found = [
        moves(f"{id}-moves", f"{function} draws a moving picture", scene),
        follows(
            f"{id}-follows",
            f"{function} draws something that follows {what}",
            scene,
            lambda truth: _body(question, truth),
        ),
    ]
    if question["body"]["L"]:
        label = f"what {function} draws along L stays fixed"
        found.append(
            keeps_momentum(f"{id}-drawn-momentum", label, scene, lambda truth: _body(question, truth))
        )
    return found


def _body(question: Mapping[str, Any], truth: Arrays) -> Any:
    from polhode.kinds.animation.body.body_motion import Body

    body = question["body"]
    L, half = (np.asarray(truth[body[name]]) if body[name] else None for name in ("L", "half"))
    return Body(truth[question["time"]], np.asarray(truth[body["R"]]), body["axis"], L, half)


def _followed(question: Mapping[str, Any], seen: Arrays, truth: Arrays) -> dict[str, Any]:
    from polhode.kinds.animation.trajectories import followed

    curves = {name: np.asarray(truth[name]) for name in question["follow"]}
    return followed(seen, np.asarray(truth[question["time"]]), curves, question["agree"]["limit"])


def _follows(question: Mapping[str, Any], name: str, scene: str, id: str, suffix: str) -> Check:
    tolerance = Tolerance(**question["agree"])

    def word(seen: list[Arrays], truth: list[Arrays]) -> Judgement:
        shown = _followed(question, seen[0], truth[0])[name]
        if shown.misfit is not None:
            judged = comparisons.below(shown.misfit, question["agree"]["limit"])
            return replace(judged, detail=f"{shown.sentence}, misfit: {judged.detail}")
        return Judgement(Verdict.UNMEASURED if shown.found is None else Verdict.FAIL, shown.sentence)

    return Check(
        id, f"{question['function']} draws a point that follows {name}{suffix}", (scene,), word, tolerance
    )
