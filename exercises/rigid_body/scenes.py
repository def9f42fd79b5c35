"""The scenes of notebook 2.6: each names a function and its inputs, the arrays it returns, and the exact answer."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

import reference
from exercises.assignment import ArraySpec, Inputs, Scene
from exercises.kinds.animation import RECORDING
from exercises.rigid_body import probes
from exercises.rigid_body.host_integration import DRIVE
from exercises.rigid_body.own_motion import own_motion
from exercises.rigid_body.public.parameters import BODY, BOX, NUDGE, SPIN, SPIN_TIME, SYMMETRIC, TORQUE_FREE
from exercises.rigid_body.random_motions import DRAWN
from exercises.rigid_body.turning import TURNING

Array = NDArray[np.float64]

BOOK = reference.box_moments(*BOX)
UNEQUAL = 8  # boxes with no two moments nearly equal
BOXES, TENSORS = UNEQUAL + 16, UNEQUAL + 4  # inputs of box_moments and of principal_moments
SENSED = 60  # times at which a motion's sensitivity is evaluated


def _same_energy(*direction: float) -> tuple[float, ...]:
    """Return ω(0) along ``direction`` with the kinetic energy of the torque-free scene, so that its polhode
    lies on the same ellipsoid.
    """
    energies = [float(reference.kinetic_energy(w, BODY)) for w in (TORQUE_FREE, direction)]
    return tuple(float(x) for x in np.asarray(direction) * np.sqrt(energies[0] / energies[1]))


def _trajectory(name: str, w0: tuple[float, ...], I: Any, t_end: float, n: int, *, orientation: bool = False) -> Scene:
    inputs = {"w0": list(w0), "I": list(map(float, I)), "t_end": t_end, "n": n, "orientation": orientation}
    return _motion(name, inputs, n, orientation)


def _spin(name: str, axis: int) -> Scene:
    """Return the scene of the book spun about one axis; the truth also holds the largest departure from that axis."""
    spin = _trajectory(name, spun(axis), BOOK, SPIN_TIME, 1500, orientation=True)
    return replace(spin, truth=lambda inputs: {**_exact_motion(inputs), "growth": np.array(_largest_growth(axis))})


def _motion(name: str, inputs: Inputs | Callable[[np.random.Generator], Inputs], n: int, orientation: bool) -> Scene:
    returns = {"w": ArraySpec((3, n))} | ({"R": ArraySpec((n, 3, 3))} if orientation else {})
    return Scene(
        name, "trajectory", "euler_eqs", inputs, returns, _exact_motion, budget_s=12.0, after="probes", known=("t",), drive=DRIVE
    )


def _exact_motion(inputs: Inputs) -> Mapping[str, Array]:
    """Return times, ω and R, the sensitivity κ to errors, and the angle in rad turned at the initial rate."""
    w0, I, times = inputs["w0"], inputs["I"], np.linspace(0.0, inputs["t_end"], inputs["n"])
    exact = reference.motion(w0, I, times, need="orientation" if inputs["orientation"] else "omega")
    angle = float(np.linalg.norm(w0)) * inputs["t_end"]
    known = {"kappa": np.array(reference.sensitivity(w0, I, inputs["t_end"], SENSED)), "angle": np.array(angle)}
    return {"t": exact.t, "w": exact.w} | known | ({} if exact.R is None else {"R": exact.R})


def _probes(rng: np.random.Generator) -> Inputs:
    """Draw the points of probes.py, some of them along the fixed motions."""
    return probes.draw(rng, [motion.inputs for motion in TRAJECTORIES if not callable(motion.inputs)])


def _boxes(rng: np.random.Generator) -> Inputs:
    """Draw boxes (m, a, b, c): some with no two moments nearly equal, then cubes, equal edges, plates, bars,
    large and small ones.
    """
    boxes: list[ArrayLike] = [_unequal_box(rng) for _ in range(UNEQUAL)]
    for m, a, b, c in (_unequal_box(rng) for _ in range(2)):
        long, thin = 20 * max(a, b, c), min(a, b, c) / 20
        boxes += [(m, a, a, a), (m, b, a, a), (m, a, b, a), (m, a, a, b), (m, a, b, thin), (m, long, b, c)]
    sizes = [(1e3, 1e3), (1e-3, 1e-3), (1e-3, 1e3), (1e3, 1e-3)]
    boxes += [np.array(_unequal_box(rng)) * [mass, *[length] * 3] for mass, length in sizes]
    return {"boxes": np.array(boxes)}


def _unequal_box(rng: np.random.Generator) -> tuple[float, ...]:
    while True:
        box = (rng.uniform(0.5, 3.0), *rng.uniform(0.2, 3.0, 3))
        if np.diff(np.sort(reference.box_moments(*box))).min() > 0.05 * reference.box_moments(*box).max():
            return box


def _exact_boxes(inputs: Inputs) -> Mapping[str, Array]:
    boxes = np.asarray(inputs["boxes"])
    moments = np.array([reference.box_moments(*row) for row in boxes])
    return {"moments": moments, "exact": moments, "at": boxes}


def _tilted(boxes: NDArray[np.float64], rng: np.random.Generator) -> Inputs:
    return {"tensors": [reference.box_tensor(m, a, b, c, _rotation(rng)).tolist() for m, a, b, c in boxes]}


def _rotation(rng: np.random.Generator) -> Array:
    Q = np.linalg.qr(rng.random((3, 3)))[0]
    return np.asarray(Q * np.linalg.det(Q))


def _drawn_tensors(rng: np.random.Generator) -> Inputs:
    """Draw tilted boxes, some of them diagonal already or of other sizes.

    No two moments are nearly equal: the roots of the characteristic polynomial would lose half their digits
    or become complex.
    """
    boxes = np.array([_unequal_box(rng) for _ in range(UNEQUAL)])
    given = [*np.asarray(_tilted(boxes, rng)["tensors"]), *(np.diag(reference.box_moments(*box)) for box in boxes[:2])]
    given += [size * tensor for size, tensor in zip((1e2, 1e-2), given, strict=False)]
    return {"tensors": np.array(given)}


def _exact_tensors(inputs: Inputs) -> Mapping[str, Array]:
    tensors = np.asarray(inputs["tensors"])
    moments = reference.principal_moments(tensors)
    invariants = {"trace": np.trace(tensors, axis1=1, axis2=2), "determinant": np.linalg.det(tensors)}
    return {"moments": moments} | invariants


def spun(axis: int) -> tuple[float, ...]:
    """Return ω(0) of the book spun about one axis, nudged off it."""
    return tuple(SPIN if i == axis else NUDGE * SPIN for i in range(3))


def _largest_growth(axis: int) -> float:
    """Return the largest transverse |ω| over the spin about ``axis``, over all times and not only at samples."""
    from scipy.optimize import minimize_scalar

    exact, times = reference.Exact(spun(axis), BOOK), np.linspace(0.0, SPIN_TIME, 400)

    def transverse(t: float) -> float:
        return reference.transverse_growth(exact.omega([t]), axis, SPIN)

    at, step = times[np.argmax([transverse(t) for t in times])], times[1]
    most = minimize_scalar(lambda t: -transverse(t), bounds=(at - step, at + step), method="bounded", options={"xatol": 1e-9})
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
    inputs = {"t": times, "R": given_R, last: given, "function": function, "arguments": ["t", "R", last], "seconds": 12.0}

    def truth(inputs: Inputs) -> Mapping[str, Array]:
        return {name: np.asarray(inputs[name]) for name in ("t", "R", last)}

    return Scene(name, "animation", function, inputs, FILM, truth, 15.0, replaced=own_motion)


FILMED = (1.25, 1.25, 2.0)  # not the course's: |L| must differ from the rate at which ê₃ goes round L
TILT = Rotation.from_rotvec([-2.0, 1.0, 0.0]).as_matrix()
FILM = RECORDING | {
    "own_R": ArraySpec((4000, 3, 3), up_to=True),
    "own_t": ArraySpec((4000, 1), up_to=True),
    "own_I": ArraySpec((8, 3), up_to=True),
}
THE_TENSOR = _tilted(np.array([BOX]), np.random.default_rng(7))
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
    Scene("boxes", "box", "box_moments", _boxes, {"moments": ArraySpec((BOXES, 3))}, _exact_boxes, 1.0, known=("exact", "at")),
    Scene("tensor", "tensors", "principal_moments", THE_TENSOR, {"moments": ArraySpec((1, 3))}, _exact_tensors, 1.0),
    Scene("tensors", "tensors", "principal_moments", _drawn_tensors, {"moments": ArraySpec((TENSORS, 3))}, _exact_tensors, 1.0),
    Scene(
        "probes",
        "pointwise",
        "euler_eqs",
        _probes,
        {"wdot": ArraySpec((POINTS, 3))},
        probes.exact,
        2.0,
        known=("exact", "at_w", "at_I"),
        twice=True,
    ),
    *TRAJECTORIES,
    *(_motion(name, draw, n, orientation) for name, (draw, n, orientation) in DRAWN.items()),
    *(
        Scene(name, "precession", "precession_rate", given, {"rate": ArraySpec(())}, _exact_precession, 1.0)
        for name, given in TURNING.items()
    ),
    _film("film", "animate_precession", (2.2, 0.0, 0.5), FILMED, "L"),
    _film("tumble-film", "animate_tumble", (0.1, 3.0, 0.15), BOOK, "half"),
)
