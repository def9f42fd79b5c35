"""Hard-coded moments: three constant coefficients identify the body they belong to."""

import numpy as np

from ecp.outcome import Diagnosis
from exercises.rigid_body.causes.errors import Slip
from exercises.rigid_body.public.parameters import BODY, SYMMETRIC
from exercises.rigid_body.scenes import BOOK

KNOWN = {"exercises 2 and 3": BODY, "exercises 4 and 6": SYMMETRIC, "the book": tuple(BOOK)}
AGREEMENT = 1e-9


def same_body(found: list[Slip]) -> list[Diagnosis]:
    """Return the diagnosis if all three components have the constant coefficients of one body, or of one that
    turns backwards.
    """
    values = {s.component: s.value for s in found if s.kind in ("coefficient", "zero")}
    if len(found) != 3 or len(values) != 3 or not any(s.kind == "coefficient" for s in found):
        return []
    a = np.array([values[k] for k in range(3)])
    for where, moments in KNOWN.items():
        for sign in (1, -1):
            if np.allclose(a, sign * _coefficients(np.array(moments)), rtol=AGREEMENT, atol=AGREEMENT):
                cause = _cause(f"euler_eqs always uses the moments of {where} and ignores its argument I")
                reversed_ = Diagnosis(code="sign-reversed", sentence="all three components have the opposite sign", confidence=1.0)
                return [cause] if sign == 1 else [cause, reversed_]
    if abs(a.sum() + a.prod()) <= AGREEMENT and a[1] != 1:
        second = (1 + a[0]) / (1 - a[1])
        ratio = f"1 : {second:.6g} : {1 + a[1] * second:.6g}"
        return [_cause(f"euler_eqs always uses moments in the ratio {ratio} and ignores its argument I")]
    return []


def _coefficients(I: np.ndarray) -> np.ndarray:
    return np.asarray((np.roll(I, -1) - np.roll(I, -2)) / I)


def _cause(sentence: str) -> Diagnosis:
    return Diagnosis(code="hard-coded-moments", sentence=sentence, confidence=1.0)
