"""False ✗ over random bodies, and the cost of checking an animation relative to drawing it.

``make bench`` runs this. BODIES=10000 repeats the published figure (ten minutes on two cores).
"""

import os
import statistics
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

import reference
from exercises.authoring.assignments.catalogue import find
from polhode.animation import animate, animation_recording
from polhode.kinds import play
from polhode.kinds.animation.body import Body, body_shown, momentum_shown
from polhode.kinds.motions import as_closely
from service.grading.sandbox_job import draw_inputs, truth

ASSIGNMENT = find("rigid-body")
BODIES = int(os.environ.get("BODIES", "700"))
MOTIONS, SAMPLES = 7, 200  # of one grading; of a motion
LEVI_CIVITA = np.zeros((3, 3, 3))
for _i, _j, _k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
    LEVI_CIVITA[_i, _j, _k], LEVI_CIVITA[_i, _k, _j] = 1, -1


def terms(t, w, I):
    """Euler's equations component by component."""
    I1, I2, I3 = I
    return [(I2 - I3) / I1 * w[1] * w[2], (I3 - I1) / I2 * w[2] * w[0], (I1 - I2) / I3 * w[0] * w[1]]


def roll(t, w, I):
    """Euler's equations by cyclic shifts."""
    return (np.roll(I, -1) - np.roll(I, -2)) * np.roll(w, -1) * np.roll(w, -2) / I


def hat(t, w, I):
    """Euler's equations with the cross-product matrix."""
    matrix = np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
    return -np.diag(1 / I) @ matrix @ np.diag(I) @ w


FORMULATIONS = (
    terms,
    roll,
    hat,
    lambda t, w, I: np.cross(I * w, w) / I,
    lambda t, w, I: np.linalg.solve(np.diag(I), -np.cross(w, np.diag(I) @ w)),
    lambda t, w, I: np.einsum("ijk,j,k->i", LEVI_CIVITA, I * w, w) / I,
)


def motion(number: int) -> tuple[float, int]:
    """Return the largest share of their tolerances that a correct function uses on the random motions of one
    grading, and its false ✗ at the points.
    """
    probes, function = ASSIGNMENT.scene("probes"), FORMULATIONS[number % len(FORMULATIONS)]
    asked = draw_inputs(probes, 10_000 + number)
    exact, given = truth(probes, asked), {name: asked[name] for name in ("t", "w", "I")}
    seen = play(dict(probes.question), {"euler_eqs": function}, given)
    used = 0.0
    for name, drawn in asked["motions"].items():
        if name in [scene.name for scene in ASSIGNMENT.scenes]:
            continue
        right = reference.motion(drawn.start["w"], drawn.start["I"], np.linspace(0, drawn.until, SAMPLES)).w
        found = play(
            dict(ASSIGNMENT.scene("torque-free").question),
            {"euler_eqs": function},
            {**drawn.inputs, "samples": SAMPLES},
        )["w"]
        off = np.abs(found - right).max() / np.linalg.norm(drawn.start["w"])
        known = {key.removeprefix(f"{name}: "): x for key, x in exact.items() if key.startswith(f"{name}: ")}
        used = max(used, float(off / as_closely(known).limit))
    pointwise = next(c for e in ASSIGNMENT.exercises for c in e.checks if c.id == "2-pointwise")
    answers = seen | {name: exact[name] for name in probes.known}
    return used, int(pointwise.judge([answers], [exact]).verdict != "pass")


def false_alarms() -> None:
    """Print the share of the tolerance that correct functions use."""
    with ProcessPoolExecutor() as pool:
        found = list(pool.map(motion, range(max(BODIES // MOTIONS, 1)), chunksize=5))
    print(
        f"{MOTIONS * len(found)} random motions, correct functions in 6 formulations:"
        f" {sum(f for _, f in found)} false ✗ at their points, {sum(u > 1 for u, _ in found)} of motions; at"
        f" most {max(u for u, _ in found):.3f} of a tolerance used"
    )


def animations() -> None:
    """Print the cost of recording and checking an animation relative to drawing its frames and stills."""
    folder, ratios = ASSIGNMENT.folder / "samples", []
    scene = ASSIGNMENT.scene("film")
    given = truth(scene, scene.inputs)
    body = Body(given["t"], given["R"], 2, given["L"])
    for file in sorted(folder.glob("right_animation_*.py"))[::3]:
        bare, checked = (min(_draw_time(file, body, follow) for _ in range(2)) for follow in (False, True))
        ratios.append(checked / bare)
    print(
        f"{len(ratios)} animations checked: {statistics.median(ratios):.3f} times bare drawing, at most"
        f" {max(ratios):.3f}"
    )


def _draw_time(file: Path, body: Body, follow: bool) -> float:
    from matplotlib import pyplot as plt

    names = {}
    exec(ASSIGNMENT.setup + "\n" + file.read_text(), names)
    real = animation_recording.drawn
    animation_recording.drawn = real if follow else lambda figure: []
    try:
        began = time.process_time()
        with animate.watched():
            seen = play(dict(ASSIGNMENT.scene("film").question), names, {})
        if follow:
            body_shown(seen, body)
            momentum_shown(seen, body)
        return time.process_time() - began
    finally:
        animation_recording.drawn = real
        plt.close("all")


if __name__ == "__main__":
    animations()
    false_alarms()
