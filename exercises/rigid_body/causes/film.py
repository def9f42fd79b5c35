"""The likely cause behind an animation that does not show the motion it was given."""

from ecp.checks import Arrays
from ecp.kinds.animation.body import diagnose
from ecp.outcome import Diagnosis
from exercises.assignment import Inputs
from exercises.rigid_body.public.common_checks import filmed


def causes_of_film(inputs: Inputs, seen: Arrays) -> list[Diagnosis]:
    """Return the cause: nothing moves; L moves, as in a drawing in body axes; or what moves follows something
    other than the body.
    """
    return diagnose(seen, filmed(inputs))
