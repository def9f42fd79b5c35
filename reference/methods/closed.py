"""The exact solution as one more point of the charts, in NumPy as it grades."""

from reference.exact import Exact
from reference.method import Method, Run, Scene


def _exact(scene: Scene, _: float) -> Run:
    sampled = Exact(scene.w0, scene.I).sample(scene.t, orientation=True)
    assert sampled.R is not None
    return Run(sampled.w, sampled.R, 1)


CLOSED = Method("exact", "closed form", None, (0.0,), _exact)
