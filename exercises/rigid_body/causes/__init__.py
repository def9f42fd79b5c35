"""The likely causes of wrong answers: of rates at the probes, moments, a precession rate, or an animation."""

import numpy as np

from exercises.authoring.assignments.assignment import Answers, Inputs
from exercises.rigid_body import probes
from exercises.rigid_body.causes.moments import causes_of_boxes, causes_of_tensors
from exercises.rigid_body.causes.precession import causes_of_rate
from exercises.rigid_body.causes.rates import causes_of_rates
from exercises.rigid_body.public.common_checks import filmed
from exercises.rigid_body.public.quantities import Array
from polhode.judging.checks import Arrays
from polhode.judging.outcome import Diagnosis
from polhode.kinds.animation.body import diagnose

CODES = (
    *(
        "sign-flipped",
        "sign-reversed",
        "cyclic-order",
        "component-order",
        "missing-division",
        "wrong-divisor",
    ),
    *(
        "constant-factor",
        "moment-sum",
        "returns-zero",
        "missing-component",
        "returns-input",
        "missing-term",
        "moment-order",
    ),
    *(
        "hard-coded-moments",
        "extra-term",
        "time-dependent",
        "precision-loss",
        "diagonal-only",
        "wrong-quantity",
        "units",
    ),
    *(
        "not-unwrapped",
        "signature",
        "swapped-arguments",
        "not-finite",
        "mutates-input",
        "returns-nothing",
        "wrong-shape",
    ),
    *(
        "no-animation",
        "static",
        "wrong-axis",
        "transposed-rotation",
        "moving-angular-momentum",
        "reversed-angular-momentum",
    ),
    *(
        "wrong-angular-momentum",
        "wrong-motion",
        "wrong-frames",
        "wrong-proportions",
        "mirrored",
        "too-many-frames",
    ),
    *(
        "missing-brackets",
        "absolute-value",
        "floor-division",
        "clipped",
        "normalised",
        "inverted-moments",
        "wrong-power",
    ),
    *("partly-right", "nearly-right", "wrong-times", "wrong-components", "unbounded"),
    "not-deterministic",
)
"""The diagnosis codes of this assignment; docs/checks.md describes them."""

NOT_DETERMINISTIC = (
    "euler_eqs does not always return the same value for the same arguments: it must not use the clock,"
    " random numbers or results of earlier calls"
)


def differs_when_repeated(inputs: Inputs, answers: Array) -> bool:
    """Return whether answers (n, 3) to equal points (t, ω, I) differ in any bit."""
    points = np.column_stack([inputs["t"], inputs["w"], inputs["I"]])
    _, first, which = np.unique(points, axis=0, return_index=True, return_inverse=True)
    return answers.tobytes() != answers[first[which]].tobytes()


def diagnose_function(function: str, answers: Answers) -> list[Diagnosis] | None:
    """Return the likely cause that explains a function's answers in all its scenes, or None if each scene is
    diagnosed alone.
    """
    with np.errstate(all="ignore"):
        if function == "precession_rate":
            return causes_of_rate(answers)
        if function == "principal_moments":
            tensors = np.concatenate(
                [np.asarray(inputs["tensors"], dtype=float) for inputs, _ in answers.values()]
            )
            return causes_of_tensors(
                tensors, np.concatenate([seen["moments"] for _, seen in answers.values()])
            )
    return None


def diagnose_scene(scene: str, inputs: Inputs, seen: Arrays) -> list[Diagnosis]:
    """Return the likely cause behind the numbers of one scene, which may overflow arithmetic."""
    with np.errstate(all="ignore"):
        if scene in ("film", "tumble-film"):
            return diagnose(seen, filmed(inputs))
        if scene == "probes":
            if differs_when_repeated(inputs, seen["wdot"]):
                return [Diagnosis("not-deterministic", NOT_DETERMINISTIC, 1.0)]
            return causes_of_rates(*probes.without_drawn(inputs, seen["wdot"]))
        if scene == "boxes":
            return causes_of_boxes(inputs, np.asarray(seen["moments"]))
    return []
