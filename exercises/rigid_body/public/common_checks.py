"""Parts that several exercises share: places in arrays, reasons for tolerances, ω(t) and R(t) against the
exact motion.
"""

import numpy as np

from ecp.animation_recording import moving_share
from ecp.checks import Arrays, Check, holds, shows, within

from .animation_checks import STILL, body_shown
from .tolerance import as_closely

NOTEBOOK = "the notebook's own tolerance"
DRIVE = "the integrator, at rtol 1e-11, stays within 1e-9 of the exact motion on this scene"

SLOW = 0.3  # share of the drawing time spent in clearing axes above which a hint says so
PRODUCT = "rtol × (sensitivity + angle turned) × safety, computed for each scene"


def at_time(index: tuple[int, ...], seen: Arrays) -> str:
    """Return the time of an index into a series (n,)."""
    return f"t = {seen['t'][index[0]]:.4g} s"


def at_component(index: tuple[int, ...], seen: Arrays) -> str:
    """Return component and time of an index into ω (3, n)."""
    return f"ω{'₁₂₃'[index[0]]}, t = {seen['t'][index[1]]:.4g} s"


def omega(id: str, label: str, scene: str) -> Check:
    """Check that ω (3, n) of a trajectory agrees with the exact motion, as closely as the scene allows any
    integrator.
    """
    return within(
        id,
        label,
        scene,
        measured=lambda seen: seen["w"],
        expected=lambda truth: truth["w"],
        scale=lambda truth: np.linalg.norm(truth["w"][:, 0]),
        limit=as_closely,
        reason=f"of |ω(0)|: {PRODUCT}",
        locate=at_component,
    )


def attitude(id: str, label: str, scene: str) -> Check:
    """Check that R (n, 3, 3) of a trajectory agrees with the exact motion, as closely as the scene allows any
    integrator.
    """
    return within(
        id,
        label,
        scene,
        measured=lambda seen: seen["R"],
        expected=lambda truth: truth["R"],
        scale=lambda truth: 1.0,
        limit=as_closely,
        reason=PRODUCT,
        locate=lambda index, seen: f"R{index[1] + 1}{index[2] + 1}, t = {seen['t'][index[0]]:.4g} s",
    )


def film(number: str, scene: str, function: str, axis: int | None, what: str) -> tuple[Check, ...]:
    """Check that an animation moves, and that something drawn follows body axis ``axis``, or for None the body."""

    def follows(seen: Arrays, truth: Arrays) -> tuple[bool | None, str]:
        shown = body_shown(seen, truth["t"], truth["R"], axis, truth.get("L"), half=truth.get("half"))
        return shown.found, shown.sentence

    return (
        holds(
            f"{number}-moves",
            f"{function} draws a moving picture",
            scene,
            claim=_moves,
            reason="a picture in which fewer than one pixel in ten thousand changes does not move",
            hint=_cost,
        ),
        shows(
            f"{number}-follows",
            f"{function} draws something that follows {what}",
            scene,
            claim=follows,
            reason="a direction from a fixed point or points of the body, to 3 % of the path; samples within 1.5 of an even run",
        ),
    )


def _moves(seen: Arrays) -> tuple[bool, str]:
    share = moving_share(seen["frames"])
    if share > STILL and not seen["visible"][0]:
        return False, f"{len(seen['frames'])} stills, in which nothing changes but text"
    return share > STILL, f"{len(seen['frames'])} stills, up to {share:.2%} of the picture changes"


def _cost(seen: Arrays) -> list[str]:
    frames, drawing, clearing, left_open, _, unkept = seen["cost"]
    hints = []
    if clearing > SLOW * drawing and clearing > 1e-3 * frames:
        part = "more than half" if clearing > drawing / 2 else "about a third"
        hints.append(f"clearing the axes takes {part} of the drawing time: keep the artists and set their data instead")
    if left_open:
        hints.append("the figure stays open, so a notebook shows an extra still: call plt.close(fig) before you return")
    if unkept:
        hints.append("the sandbox has no files: your function stopped at one, so the animation it had made was graded")
    return hints
