"""The exact motion compiled with numba: set-up in double-double arithmetic, one fused loop over the samples.

For the direct and the dual model, that is for every body in general motion; the others are left to ``reference.Exact``, whose
answers these agree with to rounding. Not imported by ``import reference``.
"""

from reference.compiled.motion import compiled_motion

__all__ = ["compiled_motion"]
