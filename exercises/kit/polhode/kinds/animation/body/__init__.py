"""A rotating body in an animation: attitudes R(t) are given, and a body axis, the angular momentum or a box
is drawn.

The drawing may have any style and the student's own camera. ``Body`` is the data, ``follows`` and
``keeps_momentum`` are checks of a scene that returns the recording of an animation.
"""

from collections.abc import Callable

from polhode.judging.checks import Arrays, Check, shows
from polhode.judging.outcome import Diagnosis
from polhode.kinds.animation.body.body_motion import Body
from polhode.kinds.animation.body.comparing import body_shown
from polhode.kinds.animation.body.momentum import momentum_shown
from polhode.kinds.animation.visibility import Shown, standstill

__all__ = ["Body", "body_shown", "diagnose", "follows", "keeps_momentum", "momentum_shown"]

AGREE = (
    "a direction from a fixed point or points of the body, to 3 % of the path; samples within 1.5 of an"
    " even run"
)


def follows(id: str, label: str, scene: str, body: Callable[[Arrays], Body]) -> Check:
    """Check that something drawn follows the axis of ``body(truth)``, or for no axis any points of it."""
    return _shows(id, label, scene, lambda seen, truth: body_shown(seen, body(truth)), AGREE)


def keeps_momentum(id: str, label: str, scene: str, body: Callable[[Arrays], Body]) -> Check:
    """Check that what is drawn along the angular momentum of ``body(truth)`` stays there."""
    return _shows(
        id,
        label,
        scene,
        lambda seen, truth: momentum_shown(seen, body(truth)),
        "without torque L is constant in space",
    )


def _shows(id: str, label: str, scene: str, shown: Callable[[Arrays, Arrays], Shown], reason: str) -> Check:
    def claim(seen: Arrays, truth: Arrays) -> tuple[bool | None, str]:
        found = shown(seen, truth)
        return found.found, found.sentence

    return shows(id, label, scene, claim=claim, reason=reason)


def diagnose(seen: Arrays, body: Body) -> list[Diagnosis]:
    """Return why the picture does not move, why L does, or what is followed instead of the body."""
    if sentence := standstill(seen):
        return [Diagnosis("static", sentence, 1.0)]
    momentum = None if body.L is None else momentum_shown(seen, body)
    shown = momentum if momentum and momentum.found is False else body_shown(seen, body)
    if momentum and not shown.code:
        shown = momentum
    return [Diagnosis(shown.code, shown.sentence, 1.0)] if shown.code else []
