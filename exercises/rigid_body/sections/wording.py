"""What several exercises say in the same way: places in arrays, reasons for tolerances, ω(t) against the exact motion."""

from exercises.checks import Arrays, Check, close

NOTEBOOK = "the notebook's own tolerance"
ROUNDING = "only rounding separates two spellings of the same algebra at these magnitudes"
DRIVE = "the integrator, at rtol 1e-11, strays less than 1e-9 from the exact motion on this scene"


def at_time(index: tuple[int, ...], seen: Arrays) -> str:
    """The time of an index into a series (n,)."""
    return f"t = {seen['t'][index[0]]:.4g} s"


def at_component(index: tuple[int, ...], seen: Arrays) -> str:
    """Component and time of an index into ω (3, n)."""
    return f"ω{'₁₂₃'[index[0]]}, t = {seen['t'][index[1]]:.4g} s"


def at_moment(index: tuple[int, ...], seen: Arrays) -> str:
    """Moment and body of an index into moments (n, 3)."""
    return f"I{'₁₂₃'[index[1]]}, body {index[0] + 1} of {len(seen['moments'])}"


def omega(id: str, label: str, scene: str, atol: float = 1e-8, reason: str = DRIVE) -> Check:
    """ω (3, n) of a trajectory agrees with the exact motion."""
    return close(
        id,
        label,
        scene,
        measured=lambda seen: seen["w"],
        expected=lambda truth: truth["w"],
        rtol=0.0,
        atol=atol,
        reason=reason,
        locate=at_component,
    )


def pointwise(id: str) -> Check:
    """``euler_eqs`` is right at secret (t, ω, I). Every exercise it drives makes this check: its own scene alone, with one body
    known to everybody, would accept equations that are right for that body only."""
    return close(
        id,
        "euler_eqs agrees with Euler's equations point by point",
        "probes",
        measured=lambda seen: seen["wdot"],
        expected=lambda truth: truth["wdot"],
        rtol=1e-12,
        atol=1e-12,
        reason=ROUNDING,
        locate=_at_probe,
    )


def _at_probe(index: tuple[int, ...], seen: Arrays) -> str:
    return f"ω̇{'₁₂₃'[index[1]]}, probe {index[0] + 1} of {len(seen['wdot'])}"
