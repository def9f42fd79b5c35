"""The likely cause behind an animation that does not show the motion it was given."""

import numpy as np

from ecp.checks import Arrays
from ecp.kinds.animation.shown import standstill
from ecp.outcome import Diagnosis
from exercises.assignment import Inputs
from exercises.rigid_body.public.animation_checks import body_shown
from exercises.rigid_body.public.momentum import momentum_shown


def causes_of_film(inputs: Inputs, seen: Arrays) -> list[Diagnosis]:
    """Return the cause: nothing moves; L moves, as in a drawing in body axes; or what moves follows something
    other than the body.
    """
    t, R = np.asarray(inputs["t"]), np.asarray(inputs["R"])
    if sentence := standstill(seen):
        return [Diagnosis(code="static", sentence=sentence, confidence=1.0)]
    tumble = "L" not in inputs
    L = None if tumble else np.asarray(inputs["L"])
    half = np.asarray(inputs["half"]) if tumble else None
    momentum = None if L is None else momentum_shown(seen, t, R, L)
    shown = momentum if momentum and momentum.found is False else body_shown(seen, t, R, None if tumble else 2, L, half=half)
    if momentum and not shown.code:
        shown = momentum
    return [Diagnosis(code=shown.code, sentence=shown.sentence, confidence=1.0)] if shown.code else []
