"""Motions that the common right ways to write Euler's equations give, with the calls that an integration of each makes.

The next call of an integration depends only on what the calls before returned. So a function that returns the same numbers, bit for
bit, at all recorded calls has the recorded motion, and need not be integrated: the calls take a quarter of the time.
"""

import base64
import hashlib
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ecp.checks import Arrays
from exercises.assignment import Inputs, Recorded
from exercises.rigid_body.plays import FIRST_CALLS, trajectory
from exercises.rigid_body.public.quantities import Array

Function = Callable[[float, Array, Array], Array]


def recorded(inputs: Inputs) -> Recorded:
    """Return the recorded motions of a scene with fixed ``inputs``, which ``plays.trajectory`` recognises."""
    return Recorded(lambda: [_record(function, inputs) for function in _forms()])


def _record(function: Function, inputs: Inputs) -> tuple[dict[str, Any], Arrays]:
    calls, returned = list[list[float]](), list[bytes]()

    def recording(t: float, w: Array, I: Array) -> Array:
        rate = function(t, w, I)
        calls.append([t, *w.tolist()])
        returned.append(rate.tobytes())
        return rate

    arrays: Arrays = trajectory({"euler_eqs": recording}, inputs)  # type: ignore[no-untyped-call]
    first, all = (hashlib.sha256(b"".join(returned[:count])).hexdigest() for count in (FIRST_CALLS, len(returned)))
    return {"calls": base64.b64encode(np.array(calls).tobytes()).decode(), "first": first, "all": all}, arrays


def _forms() -> Iterator[Function]:
    """Yield functions that round differently, the commonest first: nine of ten right samples round like one of them."""
    yield lambda t, w, I: np.cross(I * w, w) / I
    yield lambda t, w, I: np.array([d * a * b / i for d, a, b, i in _terms(w, I)])
    yield lambda t, w, I: np.array([d / i * a * b for d, a, b, i in _terms(w, I)])
    yield lambda t, w, I: np.array([d / i * (a * b) for d, a, b, i in _terms(w, I)])


def _terms(w: Array, I: Array) -> list[tuple[float, float, float, float]]:
    (w1, w2, w3), (I1, I2, I3) = w.tolist(), I.tolist()
    return [(I2 - I3, w2, w3, I1), (I3 - I1, w3, w1, I2), (I1 - I2, w1, w2, I3)]
