"""The exact motion compiled with numba: set-up in double-double arithmetic, one fused loop over the samples.

It computes the direct and the dual model, that is every body in general motion, and leaves the others to
``reference.Exact``, with which it agrees to rounding. ``import reference`` does not import it.
"""

from reference.compiled.motion import compiled_motion

__all__ = ["compiled_motion"]
