"""The exact solution as two more points of the charts: compiled like the steppers, and in NumPy."""

from reference.compiled import compiled_motion
from reference.exact import Exact
from reference.method import Method, Run, Scene


def _compiled(scene: Scene, _: float) -> Run:
    w, R = compiled_motion(scene.w0, scene.I, scene.t)
    assert R is not None
    return Run(w, R, 1)


def _numpy(scene: Scene, _: float) -> Run:
    sampled = Exact(scene.w0, scene.I).sample(scene.t, orientation=True)
    assert sampled.R is not None
    return Run(sampled.w, sampled.R, 1)


CLOSED = (
    Method("exact", "closed form", None, (0.0,), _compiled),
    Method("exact, NumPy", "closed form", None, (0.0,), _numpy),
)
