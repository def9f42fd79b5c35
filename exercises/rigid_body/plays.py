"""The calls of a submission's functions, inside the sandbox: numbers in, arrays out, no judgement and no
truth.

Each play takes the submission's names and a scene's inputs and returns arrays by name. It uses its own
integrator, bound before the submission runs, so that replacing ``solve_ivp`` changes nothing here.
"""

import math
import re
import types
from math import isfinite

import numpy as np

import polhode.animation.animate
from polhode.animation.animation_recording import record
from polhode.judging.integration import IntegrationStopped, integrate
from polhode.judging.notes import remark
from polhode.judging.return_value import WrongAnswer, check_signature, exchanged, real_array
from polhode.judging.timing import seconds_of_a_call, timed_runs

# The notebook's settings. A right submission needs under 4000 calls on every scene.
RTOL, ATOL, MOST_CALLS = 1e-11, 1e-13, 40_000
UNBOUNDED = 30.0  # times the first |ω|; energy conservation allows √(largest / smallest moment), under 6 here
CALLED = ("t", "w", "I")
FLOAT, SPIN = np.dtype(float), (3,)
OVERWRITES = (
    "euler_eqs returns the same array at each call and overwrites it: SciPy's DOP853 alone is off by 5e-4 "
    "with it; return a new array"
)
MOST_OWN = 4000  # samples of a notebook's own motion
UNKNOWN = np.zeros((2, 3, 3))  # replaces the attitudes of an animation if they are not known
NOT_OWN = {"own_R": np.zeros((1, 3, 3)), "own_t": np.zeros((1, 1)), "own_I": np.zeros((1, 3))}


def box(student, inputs):
    """Return ``box_moments`` of each row (m, a, b, c)."""
    function = student["box_moments"]
    check_signature(function, ("m", "a", "b", "c"), "box_moments")
    rows = [
        real_array(function(*map(float, row)), (3,), "box_moments") for row in np.asarray(inputs["boxes"])
    ]
    return {"moments": np.array(rows)}


def tensors(student, inputs):
    """Return ``principal_moments`` of each tensor (3, 3), in the order the function returned them."""
    function = student["principal_moments"]
    check_signature(function, ("tensor",), "principal_moments")
    rows = [
        real_array(function(np.array(tensor)), (3,), "principal_moments")
        for tensor in np.asarray(inputs["tensors"])
    ]
    return {"moments": np.array(rows)}


def pointwise(student, inputs):
    """Call ``euler_eqs`` once per probe, with its own copies of the arguments."""
    function = student["euler_eqs"]
    check_signature(function, CALLED, "euler_eqs")
    answers, before = [], None
    for t, w, I in zip(inputs["t"], np.asarray(inputs["w"]), np.asarray(inputs["I"]), strict=True):
        spin, moments = w.copy(), I.copy()
        try:
            answer = function(float(t), spin, moments)
        except (TypeError, IndexError, ValueError):
            if own := exchanged(function, CALLED):
                raise WrongAnswer(
                    "swapped-arguments", f"euler_eqs is called as (t, w, I); yours takes {own}"
                ) from None
            raise
        answers.append(_rate(answer).tobytes())
        if not (_equal(spin, w) and _equal(moments, I)):
            raise WrongAnswer(
                "mutates-input", "euler_eqs changes its arguments: work on copies, or build a new array"
            )
        if before is not None and _rate(before).tobytes() != answers[-2]:
            remark(OVERWRITES)
        before = answer
    return {"wdot": np.frombuffer(b"".join(answers)).reshape(-1, 3)}


def _equal(a, b):
    return a.tobytes() == b.tobytes() or np.array_equal(a, b, equal_nan=True)


def trajectory(student, inputs):
    """Integrate the motion that ``euler_eqs`` drives: ω alone, or with the attitude if ``orientation`` is
    set.
    """
    function = student["euler_eqs"]
    times = np.linspace(0.0, float(inputs["t_end"]), int(inputs["n"]))
    start, rates, calls = driven(function, inputs)
    try:
        y = integrate(rates, start, times, RTOL, ATOL)
    except (WrongAnswer, IntegrationStopped) as error:
        if math.hypot(*calls[1]) > UNBOUNDED * math.hypot(*start[:3]):
            raise WrongAnswer("unbounded", "ω grows without bound (energy is not conserved)") from None
        if isinstance(error, WrongAnswer):
            raise
        raise WrongAnswer(None, f"the integration stopped at t = {error.last:.3g} s: {error}") from None
    return {"w": y[:3]} | ({"R": y[3:].T.reshape(-1, 3, 3)} if inputs["orientation"] else {})


def _rate(answer):
    """Return what ``euler_eqs`` returned as float64 of shape (3,): itself in the common case, as
    ``real_array`` takes longer.
    """
    if type(answer) is np.ndarray and answer.dtype is FLOAT and answer.shape == SPIN:
        return answer
    return real_array(answer, SPIN, "euler_eqs")


def driven(function, inputs, most=MOST_CALLS):
    """Return start and right-hand side (``polhode.judging.integration.Rates``) of the motion that
    ``function`` drives, and a list of the number of its calls, ``most`` at most, and the last ω.
    """
    moments, calls = np.asarray(inputs["I"], dtype=float), [0, inputs["w0"]]

    def rates(y, out):
        spin, turn = y[:3], np.zeros((3, 3))
        R, R_rate, turned = y[3:].reshape(-1, 3), out[3:].reshape(-1, 3), turn.ravel()

        def evaluate(t):
            calls[0] += 1
            calls[1] = w = spin.copy()
            if calls[0] > most:
                raise WrongAnswer(
                    None, f"the integration stalled at t = {t:.3g} s after {most} calls of euler_eqs"
                )
            rate = _rate(function(t, w, moments.copy()))
            x, y, z = rate.tolist()
            if not (isfinite(x) and isfinite(y) and isfinite(z)):
                raise WrongAnswer(
                    "not-finite", f"euler_eqs returned {rate.tolist()} at t = {t:.3g} s: not finite"
                )
            out[0], out[1], out[2] = x, y, z
            if len(R):
                w1, w2, w3 = spin.tolist()
                turned[1], turned[2], turned[3], turned[5], turned[6], turned[7] = -w3, w2, w3, -w1, -w2, w1
                R.dot(turn, R_rate)

        return evaluate

    start = np.asarray(inputs["w0"], dtype=float)
    return np.concatenate([start, np.eye(3).ravel()]) if inputs["orientation"] else start, rates, calls


def sweep(student, inputs):
    """Integrate one motion by several solvers and tolerances; return motions, calls and CPU seconds, and the
    seconds of one call.
    """
    function, times = student["euler_eqs"], np.array(inputs["t"])
    w0, moments = np.array(inputs["w0"], dtype=float), np.array(inputs["I"], dtype=float)
    per_call = seconds_of_a_call(lambda: function(0.0, w0, moments))
    most = inputs["most_calls"]
    runs = timed_runs(lambda: driven(function, inputs, most), times, inputs["settings"], 1.0, most)
    return {
        "w": np.array([run.states[:3] for run in runs]),
        "calls": np.array([run.calls for run in runs], float),
        "seconds": np.array([run.seconds for run in runs]),
        "per_call": np.array(per_call),
    }


def precession(student, inputs):
    """Return ``precession_rate`` of a given motion: one number."""
    check_signature(student["precession_rate"], ("t", "w"), "precession_rate")
    rate = student["precession_rate"](np.array(inputs["t"]), np.array(inputs["w"]))
    return {"rate": real_array(rate, (), "precession_rate")}


def animation(student, inputs):
    """Record the animation of the function that ``inputs`` names. One that a cell showed comes with the
    numbers it may have been drawn from.
    """
    name, arguments = inputs["function"], inputs["arguments"]
    function = student[name]
    check_signature(function, tuple(arguments), name)
    own = function.own if isinstance(function, FromCell) else NOT_OWN
    return (
        record(
            lambda: function(*(np.array(inputs[argument]) for argument in arguments)),
            float(inputs["seconds"]),
        )
        | own
    )


class FromCell:
    """An animation that a cell showed, used if there is no function; ``own`` are numbers of the notebook."""

    def __init__(self, anim, own):
        self.anim, self.own = anim, own

    def __call__(self, t, R, L):
        """Return the animation, which was drawn from the notebook's own numbers."""
        return self.anim


def adopt(student, source):
    """Return ``animate_precession`` for a notebook whose cell ``source`` shows an animation of a symmetric
    top's motion.

    That cell, or a function it calls, names attitudes R (n, 3, 3) whose ê₃ runs on a circle, or that ê₃.
    Their times and the moments may be anywhere in the notebook; names of the cell come first. If only other
    cells name such attitudes, the animation has UNKNOWN ones.
    """
    if not polhode.animation.animate.shown:
        return {}
    mentioned = set(re.findall(r"\w+", source))
    for function in [
        student[name] for name in mentioned if isinstance(student.get(name), types.FunctionType)
    ]:
        mentioned |= _names(function.__code__)
    arrays = {name: _numbers(value) for name, value in student.items() if not name.startswith("_")}
    named = [
        arrays[name]
        for name in sorted(arrays, key=lambda name: name not in mentioned)
        if arrays[name] is not None
    ]
    used = [arrays[name] for name in arrays if name in mentioned and arrays[name] is not None]
    cones = [x for x in named if _is_cone(x)]
    if not cones:
        return {}
    R = next((x for x in cones if _uses(used, x)), UNKNOWN)
    if R is UNKNOWN and "animate_precession" in student:
        return {}  # the function is to be written yet, and the cell shows something else
    times = [x for x in named if x.shape == (len(R),) and np.all(np.diff(x) > 0)]
    moments = [x for x in named if x.shape == (3,) and np.all(x > 0)][:8]
    own = {
        "own_R": R,
        "own_t": times[0][:, None] if times else np.zeros((1, 1)),
        "own_I": np.array(moments or np.zeros((1, 3))),
    }
    return {"animate_precession": FromCell(polhode.animation.animate.shown[-1], own)}


def _names(code):
    return {*code.co_names, *code.co_freevars}.union(
        *(_names(part) for part in code.co_consts if isinstance(part, types.CodeType))
    )


def _is_cone(R):
    """Return whether the ê₃ of R (n, 3, 3) runs on a circle."""
    if R.ndim != 3 or R.shape[1:] != (3, 3) or not 10 <= len(R) <= MOST_OWN:
        return False
    sizes = np.linalg.svd(R[:, :, 2] - R[:, :, 2].mean(axis=0), compute_uv=False)
    return bool(sizes[2] <= 1e-3 * sizes[0])


def _uses(used, R):
    tips = (R[:, :, 2], R[:, :, 2].T)
    return any(x is R or any(x.shape == tip.shape and np.allclose(x, tip) for tip in tips) for x in used)


def _numbers(value):
    """Return the finite real array that a value is, or None."""
    if not isinstance(value, np.ndarray | list | tuple) or len(value) == 0 or len(value) > MOST_OWN:
        return None
    try:
        array = np.array(value)
    except ValueError:
        return None
    real = array.dtype.kind in "fiu" and array.size <= 9 * MOST_OWN and bool(np.all(np.isfinite(array)))
    return array.astype(float) if real else None
