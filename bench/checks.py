"""False ✗ over random bodies, the time of a diagnosis, and the cost of checking an animation relative to
drawing it.

``make bench`` runs this. BODIES=10000 repeats the published figure (ten minutes on two cores).
"""

import contextlib
import os
import statistics
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

from exercises.authoring.assignments.catalogue import find
from exercises.authoring.mutants.mutation import variants
from exercises.rigid_body import plays
from exercises.rigid_body.causes import diagnose_scene
from exercises.rigid_body.draws import DRAWN
from exercises.rigid_body.public.common_checks import filmed
from polhode.animation import animate, animation_recording
from polhode.kinds.animation.body import body_shown, momentum_shown
from service.grading.jobs import draw_inputs, truth

ASSIGNMENT = find("rigid-body")
BODIES = int(os.environ.get("BODIES", "700"))
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
    """Return the share of its tolerance that a correct function uses on random motion ``number``, and its
    false ✗ at the probes.
    """
    name = list(DRAWN)[number % len(DRAWN)]
    scene, probes = ASSIGNMENT.scene(name), ASSIGNMENT.scene("probes")
    inputs, function = draw_inputs(scene, 10_000 + number), FORMULATIONS[number % len(FORMULATIONS)]
    exact = truth(scene, inputs)
    seen = {**plays.trajectory({"euler_eqs": function}, inputs), "t": exact["t"]}
    checks = [c for e in ASSIGNMENT.exercises for c in e.checks if c.scenes == (name,) and c.allow]
    used = max(1 / (c.judge([seen], [exact]).margin or np.inf) for c in checks)
    asked = draw_inputs(probes, number)
    pointwise = next(c for e in ASSIGNMENT.exercises for c in e.checks if c.id == "2-pointwise")
    right = truth(probes, asked)
    answers = plays.pointwise({"euler_eqs": function}, asked) | {name: right[name] for name in probes.known}
    return float(used), int(pointwise.judge([answers], [right]).verdict != "pass")


def false_alarms() -> None:
    """Print the share of the tolerance that correct functions use, for each family of motions."""
    with ProcessPoolExecutor() as pool:
        found = list(pool.map(motion, range(BODIES), chunksize=20))
    false = sum(f for _, f in found)
    print(f"{BODIES} random bodies, correct functions in 6 formulations: {false} false ✗ at 128 probes each")
    for k, name in enumerate(DRAWN):
        used = [u for number, (u, _) in enumerate(found) if number % len(DRAWN) == k]
        false = sum(u > 1 for u in used)
        print(
            f"  {name:16} {len(used):5} motions, {false} false ✗; at most {max(used):.3f} of the tolerance"
            " used"
        )


def diagnosis() -> None:
    """Print the time of a diagnosis."""
    inputs, spent = draw_inputs(ASSIGNMENT.scene("probes"), 3), []
    for variant in variants((ASSIGNMENT.folder / "samples" / "right_terms.py").read_text()):
        names = {"np": np}
        exec(variant.source, names)
        with contextlib.suppress(Exception):  # of a version that fails
            seen = plays.pointwise(names, inputs)
            spent.append(min(_milliseconds(inputs, seen) for _ in range(2)))
    print(
        f"diagnosis of {len(spent)} wrong functions: median {statistics.median(spent):.1f} ms, longest"
        f" {max(spent):.1f} ms"
    )


def _milliseconds(inputs, seen) -> float:
    began = time.process_time()
    diagnose_scene("probes", inputs, seen)
    return 1e3 * (time.process_time() - began)


def animations() -> None:
    """Print the cost of recording and checking an animation relative to drawing its frames and stills."""
    folder, ratios = ASSIGNMENT.folder / "samples", []
    inputs = ASSIGNMENT.scene("film").inputs
    for file in sorted(folder.glob("right_animation_*.py"))[::3]:
        bare, checked = (min(_draw_time(file, inputs, follow) for _ in range(2)) for follow in (False, True))
        ratios.append(checked / bare)
    print(
        f"{len(ratios)} animations checked: {statistics.median(ratios):.3f} times bare drawing, at most"
        f" {max(ratios):.3f}"
    )


def _draw_time(file: Path, inputs, follow: bool) -> float:
    from matplotlib import pyplot as plt

    names = {}
    exec(ASSIGNMENT.setup + "\n" + file.read_text(), names)
    real = animation_recording.drawn
    animation_recording.drawn = real if follow else lambda figure: []
    try:
        began = time.process_time()
        with animate.watched():
            seen = plays.animation(names, inputs)
        if follow:
            body_shown(seen, filmed(inputs))
            momentum_shown(seen, filmed(inputs))
        return time.process_time() - began
    finally:
        animation_recording.drawn = real
        plt.close("all")


if __name__ == "__main__":
    diagnosis()
    animations()
    false_alarms()
