"""The scenes of notebook 2.6: each names a function and its inputs, the arrays it returns, and the exact
answer.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

import reference
from exercises.authoring.assignments.assignment import ArraySpec, Inputs, Scene
from exercises.authoring.kinds.animation import RECORDING
from exercises.rigid_body import draws, probes
from exercises.rigid_body.own_motion import own_motion
from exercises.rigid_body.public.quantities import (
    BODY,
    BOX,
    NUDGE,
    SPIN,
    SPIN_TIME,
    SYMMETRIC,
    TORQUE_FREE,
    Array,
)

BOOK = reference.box_moments(*BOX)


def _same_energy(*direction: float) -> tuple[float, ...]:
    """Return ω(0) along ``direction`` with the kinetic energy of the torque-free scene, so that its polhode
    lies on the same ellipsoid.
    """
    energies = [float(reference.kinetic_energy(w, BODY)) for w in (TORQUE_FREE, direction)]
    return tuple(float(x) for x in np.asarray(direction) * np.sqrt(energies[0] / energies[1]))


def _trajectory(
    name: str, w0: tuple[float, ...], I: Any, t_end: float, n: int, *, orientation: bool = False
) -> Scene:
    inputs = {"w0": list(w0), "I": list(map(float, I)), "t_end": t_end, "n": n, "orientation": orientation}
    returns = {"w": ArraySpec((3, n))} | ({"R": ArraySpec((n, 3, 3))} if orientation else {})
    return Scene(
        name,
        "trajectory",
        "euler_eqs",
        inputs,
        returns,
        _exact_motion,
        budget_s=12.0,
        after="probes",
        known=("t",),
    )


def _spin(name: str, axis: int) -> Scene:
    """Return the scene of the book spun about one axis; the truth also holds the largest departure from that
    axis.
    """
    spin = _trajectory(name, spun(axis), BOOK, SPIN_TIME, 1500, orientation=True)
    return replace(
        spin, truth=lambda inputs: {**_exact_motion(inputs), "growth": np.array(_largest_growth(axis))}
    )


def _exact_motion(inputs: Inputs) -> Mapping[str, Array]:
    """Return times, ω and R, the sensitivity κ to errors, its counterpart in s, and the angle in rad turned
    at the initial rate.
    """
    w0, I, times = inputs["w0"], inputs["I"], np.linspace(0.0, inputs["t_end"], inputs["n"])
    exact = reference.motion(w0, I, times, need="orientation" if inputs["orientation"] else "omega")
    known = probes.sensitivity(probes.Motion.of(inputs))
    return {"t": exact.t, "w": exact.w, **known} | ({} if exact.R is None else {"R": exact.R})


def _probes(rng: np.random.Generator) -> Inputs:
    """Draw the points of probes.py, some of them along the fixed motions."""
    return probes.draw(
        rng, {motion.name: motion.inputs for motion in TRAJECTORIES if not callable(motion.inputs)}
    )


def _exact_boxes(inputs: Inputs) -> Mapping[str, Array]:
    boxes = np.asarray(inputs["boxes"])
    moments = np.array([reference.box_moments(*row) for row in boxes])
    return {"moments": moments, "exact": moments, "at": boxes}


def _exact_tensors(inputs: Inputs) -> Mapping[str, Array]:
    tensors = np.asarray(inputs["tensors"])
    moments = reference.principal_moments(tensors)
    invariants = {"trace": np.trace(tensors, axis1=1, axis2=2), "determinant": np.linalg.det(tensors)}
    return {"moments": moments} | invariants


def spun(axis: int) -> tuple[float, ...]:
    """Return ω(0) of the book spun about one axis, nudged off it."""
    return tuple(SPIN if i == axis else NUDGE * SPIN for i in range(3))


def _largest_growth(axis: int) -> float:
    """Return the largest transverse |ω| over the spin about ``axis``,
    over all times and not only at samples.
    """
    from scipy.optimize import minimize_scalar

    exact, times = reference.Exact(spun(axis), BOOK), np.linspace(0.0, SPIN_TIME, 400)

    def transverse(t: float) -> float:
        return reference.transverse_growth(exact.omega([t]), axis, SPIN)

    at, step = times[np.argmax([transverse(t) for t in times])], times[1]
    most = minimize_scalar(
        lambda t: -transverse(t), bounds=(at - step, at + step), method="bounded", options={"xatol": 1e-9}
    )
    return float(-most.fun)


def _exact_precession(inputs: Inputs) -> Mapping[str, Array]:
    return {"rate": np.array(reference.precession_rate(inputs["t"], inputs["w"]))}


def _film(name: str, function: str, w0: tuple[float, ...], I: Any, last: str) -> Scene:
    """Return the scene of an animation, with a motion that is not graded elsewhere: its inputs must not
    answer another scene.

    It starts from an attitude that keeps L and ê₃ off every coordinate axis and plane, where mistakes would
    look alike; the cone of ê₃ crosses each of the planes.
    """
    times = np.linspace(0.0, 4.0, 96)
    exact = reference.motion(w0, I, times, need="orientation")
    assert exact.R is not None
    given_R = TILT @ exact.R
    given = {"L": TILT @ reference.angular_momentum(w0, I), "half": np.array(BOX[1:]) / 2}[last]
    inputs = {
        "t": times,
        "R": given_R,
        last: given,
        "function": function,
        "arguments": ["t", "R", last],
        "seconds": 12.0,
    }

    def truth(inputs: Inputs) -> Mapping[str, Array]:
        return {name: np.asarray(inputs[name]) for name in ("t", "R", last)}

    return Scene(name, "animation", function, inputs, FILM, truth, 15.0, replaced=own_motion)


FILMED = (1.25, 1.25, 2.0)  # not the course's: |L| must differ from the rate at which ê₃ goes round L
ANGLE = 5**0.5
CROSS = np.cross(np.eye(3), np.array([-2.0, 1.0, 0.0]) / ANGLE)  # times v: axis × v
TILT = (
    np.eye(3) + np.sin(ANGLE) * CROSS + (1 - np.cos(ANGLE)) * CROSS @ CROSS
)  # scipy's Rotation takes 0.1 s to import
FILM = RECORDING | {
    "own_R": ArraySpec((4000, 3, 3), up_to=True),
    "own_t": ArraySpec((4000, 1), up_to=True),
    "own_I": ArraySpec((8, 3), up_to=True),
}
THE_TENSOR = draws.tilted(np.array([BOX]), np.random.default_rng(7))
TRAJECTORIES = (
    _trajectory("torque-free", TORQUE_FREE, BODY, 20.0, 3100, orientation=True),
    _trajectory("polhode-3", _same_energy(0.2, 0.3, 1.1), BODY, 20.0, 1000),
    _trajectory("polhode-1", _same_energy(1.1, 0.3, 0.2), BODY, 20.0, 1000),
    _trajectory("symmetric", (0.4, 0.0, 3.0), SYMMETRIC, 8.0, 800),
    _spin("spin-min", 0),
    _spin("spin-mid", 1),
    _spin("spin-max", 2),
    _trajectory("precession", (0.2, 0.3, 3.0), SYMMETRIC, 8.0, 80, orientation=True),
)
POINTS = probes.number_of_points(len(TRAJECTORIES))

SCENES = (
    Scene(
        "boxes",
        "box",
        "box_moments",
        draws.boxes,
        {"moments": ArraySpec((draws.BOXES, 3))},
        _exact_boxes,
        1.0,
        known=("exact", "at"),
    ),
    Scene(
        "tensor",
        "tensors",
        "principal_moments",
        THE_TENSOR,
        {"moments": ArraySpec((1, 3))},
        _exact_tensors,
        1.0,
    ),
    Scene(
        "tensors",
        "tensors",
        "principal_moments",
        draws.tensors,
        {"moments": ArraySpec((draws.TENSORS, 3))},
        _exact_tensors,
        1.0,
    ),
    Scene(
        "probes",
        "pointwise",
        "euler_eqs",
        _probes,
        {"wdot": ArraySpec((POINTS, 3))},
        probes.exact,
        2.0,
        known=("exact", "at_w", "at_I"),
        withheld=("motions", "rows"),
    ),
    *TRAJECTORIES,
    *(
        Scene(name, "precession", "precession_rate", given, {"rate": ArraySpec(())}, _exact_precession, 1.0)
        for name, given in draws.TURNING.items()
    ),
    _film("film", "animate_precession", (2.2, 0.0, 0.5), FILMED, "L"),
    _film("tumble-film", "animate_tumble", (0.1, 3.0, 0.15), BOOK, "half"),
)
