"""The allowed deviation of a right function's motion from the exact one: the integrator's errors, as the
scene magnifies them.
"""

from ecp.checks import Arrays
from ecp.outcome import Tolerance

RTOL = 1e-11  # of the integrations in plays.py
SAFETY = 10.0  # ten thousand motions of the right equations (make bench) use less than a tenth of the resulting limit


def as_closely(truth: Arrays) -> Tolerance:
    """Return the tolerance of one scene: the integrator's tolerance for every radian, magnified by the
    motion's sensitivity.
    """
    kappa, angle = float(truth["kappa"]), float(truth["angle"])
    reason = f"rtol {RTOL:g} × (sensitivity {kappa:.4g} + {angle:.4g} rad turned) × safety {SAFETY:g}"
    return Tolerance(limit=float(f"{RTOL * (kappa + angle) * SAFETY:.2e}"), reason=reason)
