"""Motions that the common right ways to write Euler's equations give, with the calls that an integration of
each makes.

The next call of an integration depends only on what the calls before returned. So a function that returns the
same numbers, bit for bit, at all recorded calls has the recorded motion, and need not be integrated. The
function is called at one of every EVERY calls, drawn at random, so at several of each integration step.
"""

import hashlib
import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from exercises.assignment import Inputs, Recorded, Recording
from exercises.rigid_body.draws import Rng
from exercises.rigid_body.plays import EVERY, FIRST_CALLS, sampled, trajectory
from exercises.rigid_body.public.quantities import Array

Function = Callable[[float, Array, Array], Array]


def recorded(inputs: Inputs) -> Recorded:
    """Return the recorded motions of a scene with fixed ``inputs``, which ``plays.trajectory`` recognises."""
    return Recorded(lambda: [_record(function, inputs) for function in _forms()], _sample)


def _sample(recordings: Sequence[Recording], rng: Rng) -> Inputs:
    """Draw which of EVERY calls to compare: ``offsets`` (k,); and ``digests`` of what each function returned
    at them, and at the first ones.
    """
    offsets = rng.integers(0, EVERY, math.ceil(max(len(one.calls) for one in recordings) / EVERY)).tolist()
    returned: list[Array] = [sampled(one.returned, offsets) for one in recordings]  # type: ignore[no-untyped-call]
    digests = [
        [hashlib.sha256(part.tobytes()).hexdigest() for part in (rates[:FIRST_CALLS], rates)]
        for rates in returned
    ]
    return {"offsets": offsets, "digests": digests}


def _record(function: Function, inputs: Inputs) -> Recording:
    calls, returned = list[list[float]](), list[Array]()

    def recording(t: float, w: Array, I: Array) -> Array:
        rate = function(t, w, I)
        calls.append([t, *w.tolist()])
        returned.append(rate)
        return rate

    arrays = trajectory({"euler_eqs": recording}, inputs)  # type: ignore[no-untyped-call]
    return Recording(np.array(calls), np.array(returned), arrays)


def _forms() -> Iterator[Function]:
    """Yield functions that round differently, the commonest first: nine of ten right samples round like one
    of them.
    """
    yield lambda t, w, I: np.cross(I * w, w) / I
    yield lambda t, w, I: np.array([d * a * b / i for d, a, b, i in _terms(w, I)])
    yield lambda t, w, I: np.array([d / i * a * b for d, a, b, i in _terms(w, I)])
    yield lambda t, w, I: np.array([d / i * (a * b) for d, a, b, i in _terms(w, I)])


def _terms(w: Array, I: Array) -> list[tuple[float, float, float, float]]:
    (w1, w2, w3), (I1, I2, I3) = w.tolist(), I.tolist()
    return [(I2 - I3, w2, w3, I1), (I3 - I1, w3, w1, I2), (I1 - I2, w1, w2, I3)]
