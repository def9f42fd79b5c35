"""The scenes of notebook 2.6: which function is called with which numbers, what comes back, and the exact answer."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import reference
from exercises.assignment import Blank, Inputs, Scene
from exercises.rigid_body.drawn import DRAWN
from exercises.rigid_body.drive import DRIVE
from exercises.rigid_body.public.setting import BODY, BOX, NUDGE, SPIN, SPIN_TIME, SYMMETRIC, TORQUE_FREE

Array = NDArray[np.float64]

BOOK = reference.box_moments(*BOX)
PROBES, REPEATS, RETIMED, NODES = 32, 8, 8, 10  # at random; of these once more; at another time; along each exact motion
SENSED = 60  # times at which a motion's sensitivity is summed up


def _same_energy(*direction: float) -> tuple[float, ...]:
    """ω(0) along ``direction`` with the kinetic energy of the torque-free scene, so that its polhode lies on the same ellipsoid."""
    energies = [float(reference.kinetic_energy(w, BODY)) for w in (TORQUE_FREE, direction)]
    return tuple(float(x) for x in np.asarray(direction) * np.sqrt(energies[0] / energies[1]))


def _trajectory(name: str, w0: tuple[float, ...], I: Any, t_end: float, n: int, *, orientation: bool = False) -> Scene:
    inputs = {"w0": list(w0), "I": list(map(float, I)), "t_end": t_end, "n": n, "orientation": orientation}
    return _motion(name, inputs, n, orientation)


def _spin(name: str, axis: int) -> Scene:
    """The book spun about one axis; the truth also holds how far the spin leaves it."""
    spin = _trajectory(name, spun(axis), BOOK, SPIN_TIME, 1500, orientation=True)
    return replace(spin, truth=lambda inputs: {**_exact_motion(inputs), "growth": np.array(_largest_growth(axis))})


def _motion(name: str, inputs: Inputs | Callable[[np.random.Generator], Inputs], n: int, orientation: bool) -> Scene:
    returns = {"w": Blank((3, n))} | ({"R": Blank((n, 3, 3))} if orientation else {})
    return Scene(
        name, "trajectory", "euler_eqs", inputs, returns, _exact_motion, budget_s=12.0, after="probes", known=("t",), drive=DRIVE
    )


def _exact_motion(inputs: Inputs) -> Mapping[str, Array]:
    """Times, ω and R, and how much of an error comes through: the sensitivity κ and the angle in rad turned at the first rate."""
    w0, I, times = inputs["w0"], inputs["I"], np.linspace(0.0, inputs["t_end"], inputs["n"])
    exact = reference.motion(w0, I, times, need="orientation" if inputs["orientation"] else "omega")
    angle = float(np.linalg.norm(w0)) * inputs["t_end"]
    known = {"kappa": np.array(reference.sensitivity(w0, I, inputs["t_end"], SENSED)), "angle": np.array(angle)}
    return {"t": exact.t, "w": exact.w} | known | ({} if exact.R is None else {"R": exact.R})


def _probes(rng: np.random.Generator) -> Inputs:
    """Random points, some twice, some again at another time, and points along the exact motions: shuffled (t, ω, I) in rows."""
    edges = rng.uniform(0.4, 2.0, (PROBES, 3))
    moments = np.array([reference.box_moments(6.0, *edge) for edge in edges])
    rows = np.column_stack([rng.uniform(0.0, 20.0, PROBES), rng.uniform(-3.0, 3.0, (PROBES, 3)), moments])
    along = [_along(scene.inputs, rng) for scene in TRAJECTORIES]
    retimed = rows[REPEATS : REPEATS + RETIMED].copy()
    retimed[:, 0] = np.where(np.arange(RETIMED) % 2, retimed[:, 0] + 20.0, rng.uniform(0.0, 0.5, RETIMED))
    rows = rng.permutation(np.concatenate([rows, rows[:REPEATS], retimed, *along]))
    return {"t": rows[:, 0], "w": rows[:, 1:4], "I": rows[:, 4:]}


def _along(inputs: Any, rng: np.random.Generator) -> Array:
    w = reference.motion(inputs["w0"], inputs["I"], rng.uniform(0.0, inputs["t_end"], NODES)).w
    told = rng.uniform(0.0, inputs["t_end"], NODES)  # not the time at which the motion is there: a student could use that
    return np.column_stack([told, w.T, np.tile(inputs["I"], (NODES, 1))])


def _exact_rates(inputs: Inputs) -> Mapping[str, Array]:
    """The rates, and beside them what was subtracted from what: rounding is a fraction of (I₂ + I₃)|ω₂ω₃|/I₁, and so on."""
    w, I = np.abs(inputs["w"]), np.asarray(inputs["I"])
    whole = (np.roll(I, -1, 1) + np.roll(I, -2, 1)) * np.roll(w, -1, 1) * np.roll(w, -2, 1) / I
    scale = np.maximum(whole, 1e-6 * whole.max(axis=1, keepdims=True))
    return {"wdot": reference.euler_rhs(np.asarray(inputs["w"]).T, I.T).T, "scale": scale}


def _boxes(rng: np.random.Generator) -> Inputs:
    """Eight boxes (m, a, b, c) with no two moments nearly equal, where eigenvalues by the characteristic polynomial lose digits."""
    boxes: list[Array] = []
    while len(boxes) < 8:
        box = np.array([rng.uniform(0.5, 3.0), *rng.uniform(0.2, 3.0, 3)])
        if np.diff(np.sort(reference.box_moments(*box))).min() > 0.05 * reference.box_moments(*box).max():
            boxes.append(box)
    return {"boxes": np.array(boxes)}


def _exact_boxes(inputs: Inputs) -> Mapping[str, Array]:
    return {"moments": np.array([reference.box_moments(*row) for row in np.asarray(inputs["boxes"])])}


def _tilted(boxes: NDArray[np.float64], rng: np.random.Generator) -> Inputs:
    turns = [np.linalg.qr(rng.random((3, 3)))[0] for _ in boxes]
    return {"tensors": [reference.box_tensor(m, a, b, c, R).tolist() for (m, a, b, c), R in zip(boxes, turns, strict=True)]}


def _drawn_tensors(rng: np.random.Generator) -> Inputs:
    return _tilted(np.asarray(_boxes(rng)["boxes"]), rng)


def _exact_tensors(inputs: Inputs) -> Mapping[str, Array]:
    tensors = np.asarray(inputs["tensors"])
    invariants = {"trace": np.trace(tensors, axis1=1, axis2=2), "determinant": np.linalg.det(tensors)}
    return {"moments": reference.principal_moments(tensors)} | invariants


def spun(axis: int) -> tuple[float, ...]:
    """ω(0) of the book spun about one axis, nudged off it."""
    return tuple(SPIN if i == axis else NUDGE * SPIN for i in range(3))


def _largest_growth(axis: int) -> float:
    """The largest transverse |ω| over the spin about ``axis``, over all times and not only at samples."""
    from scipy.optimize import minimize_scalar

    exact, times = reference.Exact(spun(axis), BOOK), np.linspace(0.0, SPIN_TIME, 400)

    def transverse(t: float) -> float:
        return reference.transverse_growth(exact.omega([t]), axis, SPIN)

    at, step = times[np.argmax([transverse(t) for t in times])], times[1]
    most = minimize_scalar(lambda t: -transverse(t), bounds=(at - step, at + step), method="bounded", options={"xatol": 1e-9})
    return float(-most.fun)


def _given_precession(rng: np.random.Generator) -> Inputs:
    return _precessing(rng, rng.uniform(1.1, 1.9))


def _given_retrograde(rng: np.random.Generator) -> Inputs:
    return _precessing(rng, rng.uniform(0.3, 0.8))


def _precessing(rng: np.random.Generator, i3: float) -> Inputs:
    """ω of a symmetric top for two to five turns, so that a phase that is not unwrapped jumps."""
    i1, w3, transverse, phase, whole = rng.uniform([1.0, 1.0, 0.1, 0.0, 2.2], [2.0, 4.0, 0.8, 6.0, 5.0])
    rate = reference.free_precession_rate((i1, i1, i1 * i3), w3)
    t = np.linspace(0.0, whole * 2 * np.pi / abs(rate), 1500)
    w = np.array([transverse * np.cos(rate * t + phase), transverse * np.sin(rate * t + phase), np.full_like(t, w3)])
    return {"t": t, "w": w}


def _exact_precession(inputs: Inputs) -> Mapping[str, Array]:
    return {"rate": np.array(reference.precession_rate(inputs["t"], inputs["w"]))}


def _film(name: str, function: str, w0: tuple[float, ...], I: Any, last: str) -> Scene:
    """A motion graded nowhere else: what an animation is given to draw must not answer another scene's question.

    It starts from an attitude that keeps L and ê₃ off every coordinate axis and plane, where mistakes would look alike.
    """
    times = np.linspace(0.0, 4.0, 96)
    exact = reference.motion(w0, I, times, need="orientation")
    assert exact.R is not None
    given_R = TILT @ exact.R
    given = {"L": TILT @ reference.angular_momentum(w0, I), "half": np.array(BOX[1:]) / 2}[last]
    inputs = {"t": times, "R": given_R, last: given, "function": function, "arguments": ["t", "R", last], "seconds": 12.0}
    return Scene(name, "animation", function, inputs, FILM, lambda _: {"t": times, "R": given_R, last: given}, 15.0)


TILT = Rotation.from_rotvec([0.5, -0.6, 0.4]).as_matrix()
FILM = {
    "frames": Blank((24, 360, 480, 3), "uint8", up_to=True),
    "tracks": Blank((48, 256, 3), up_to=True),
    "owners": Blank((256, 3), up_to=True),
    "at": Blank((48, 3), up_to=True),
    "cost": Blank((5,)),
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
ASKED = PROBES + REPEATS + RETIMED + NODES * len(TRAJECTORIES)

SCENES = (
    Scene("boxes", "box", "box_moments", _boxes, {"moments": Blank((8, 3))}, _exact_boxes, 1.0),
    Scene("tensor", "tensors", "principal_moments", THE_TENSOR, {"moments": Blank((1, 3))}, _exact_tensors, 1.0),
    Scene("tensors", "tensors", "principal_moments", _drawn_tensors, {"moments": Blank((8, 3))}, _exact_tensors, 1.0),
    Scene("probes", "pointwise", "euler_eqs", _probes, {"wdot": Blank((ASKED, 3))}, _exact_rates, 2.0, twice=True),
    *TRAJECTORIES,
    *(_motion(name, draw, n, orientation) for name, (draw, n, orientation) in DRAWN.items()),
    Scene("rate", "precession", "precession_rate", _given_precession, {"rate": Blank(())}, _exact_precession, 1.0),
    Scene("rate-retrograde", "precession", "precession_rate", _given_retrograde, {"rate": Blank(())}, _exact_precession, 1.0),
    _film("film", "animate_precession", (0.9, 0.0, 1.4), SYMMETRIC, "L"),
    _film("tumble-film", "animate_tumble", (0.1, 3.0, 0.15), BOOK, "half"),
)
