"""How far a right function's motion may be from the exact one: as far as the scene itself carries an integrator's errors."""

from ecp.checks import Arrays
from ecp.outcome import Tolerance

RTOL = 1e-11  # with which plays.py integrates
SAFETY = 10.0  # ten thousand motions of the right equations (make bench) use less than a tenth of what this allows


def as_closely(truth: Arrays) -> Tolerance:
    """What is allowed for one scene: the integrator's tolerance for every radian, as magnified as the motion magnifies it."""
    kappa, angle = float(truth["kappa"]), float(truth["angle"])
    told = f"rtol {RTOL:g} × (sensitivity {kappa:.4g} + {angle:.4g} rad turned) × safety {SAFETY:g}"
    return Tolerance(limit=float(f"{RTOL * (kappa + angle) * SAFETY:.2e}"), reason=told)
