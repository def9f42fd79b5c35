"""What an animation shows of a motion: whether it moves and can be seen, and why it cannot be judged."""

import pickle
from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple, TypeVar

from polhode.animation.animation_recording import moving_share
from polhode.judging.checks import Arrays, Check, holds
from polhode.kinds.animation.drawn_paths import Picture, changed, is_consistent, pictures
from polhode.kinds.animation.frame_times import LEAST_FRAMES, Array

T = TypeVar("T")

STILL = 1e-4  # share of the pixels; a picture in which fewer change does not move
RARELY = 0.03  # share of the frames or samples; a drawing that changes at fewer shows no motion
SLOW = 0.3  # share of the drawing time spent in clearing axes above which a hint says so
UNCHANGED = "the picture stays the same from frame to frame: does the update function change any artist?"
INVISIBLE = (
    "nothing that moves can be seen: draw it within the limits of the axes, in front, in a visible colour and"
    " width"
)
NOTHING = "nothing drawn moves but text: does update change lines, arrows, polygons or markers?"
PIXELS = "the picture is painted as pixels, and nothing else that moves shows {name}"
INCONSISTENT = "the returned arrays do not fit together"


class Shown(NamedTuple):
    """``found``: True if the motion is followed, False if not, None if the drawing cannot be judged.

    ``code`` and ``sentence`` say what is followed instead; ``cameras`` are those found for each picture, or
    None. ``misfit`` is the measured deviation, if there is one number for it.
    """

    found: bool | None
    code: str | None
    sentence: str
    cameras: tuple[Array | None, ...] = ()
    misfit: float | None = None


_last: list[Any] = []  # the last recording, what was asked of it, and the answer


def remembered(seen: Arrays, asked: Any, answer: Callable[[], T]) -> T:
    """Return ``answer()``, or the last one if ``asked`` and the recording are the same: several checks need
    the same.
    """
    key = pickle.dumps(asked)
    if not (_last and _last[0] is seen and _last[1] == key):
        _last[:] = [seen, key, answer()]
    found: T = _last[2]
    return found


def judged(
    seen: Arrays, n: int, names: Iterable[str], compared: Callable[[list[Picture]], Mapping[str, Shown]]
) -> dict[str, Shown]:
    """Return for each of ``names`` what of the recording ``seen`` follows that motion of n samples, or why it
    shows nothing.

    ``compared(pictures)`` returns what the pictures show by name.
    """
    if not is_consistent(seen):
        return dict.fromkeys(names, Shown(False, None, INCONSISTENT))
    drawn, painted, invisible, frames = (
        pictures(seen),
        seen["cost"][4] > 0,
        seen["visible"][1],
        len(seen["at"]),
    )
    if not any(picture.paths for picture in drawn):
        if painted:
            return {name: Shown(None, None, PIXELS.format(name=name)) for name in names}
        code = "static" if any(picture.still for picture in drawn) or invisible else None
        return dict.fromkeys(names, Shown(False, code, INVISIBLE if invisible else NOTHING))
    if frames < LEAST_FRAMES:
        return dict.fromkeys(
            names, Shown(False, "wrong-frames", f"too short to show the motion: {frames} frames")
        )
    found, changes = dict(compared(drawn)), changed(drawn)
    for name in (name for name in names if not found[name].found):
        unseen = "; artists that cannot be seen do not count" if invisible else ""
        if painted:
            found[name] = Shown(None, None, PIXELS.format(name=name) + unseen)
        elif found[name].found is False and changes <= RARELY * min(frames, n):
            sentence = (
                f"the drawing changes at only {changes} of {frames} frames: is each frame drawn from its own"
                " sample?"
            )
            found[name] = Shown(False, "static", sentence)
        else:
            found[name] = found[name]._replace(sentence=f"{found[name].sentence}{unseen}")
    return found


def standstill(seen: Arrays, still: float = STILL) -> str | None:
    """Return why the picture does not move, at more than the share ``still`` of its pixels;
    None if it does.
    """
    if moving_share(seen["frames"]) <= still:
        return UNCHANGED
    if not seen["visible"][0]:
        return INVISIBLE if seen["visible"][1] else NOTHING
    return None


def moves(id: str, label: str, scene: str, still: float = STILL) -> Check:
    """Return the check that the picture moves, not only its text, at more than the share ``still`` of its
    pixels.
    """

    def claim(seen: Arrays) -> tuple[bool, str]:
        share = moving_share(seen["frames"])
        if share > still and not seen["visible"][0]:
            return False, f"{len(seen['frames'])} stills, in which nothing changes but text"
        return share > still, f"{len(seen['frames'])} stills, up to {share:.2%} of the picture changes"

    few = "fewer than one pixel in ten thousand changes" if still else "no pixel changes"
    return holds(id, label, scene, claim=claim, reason=f"a picture in which {few} does not move", hint=_cost)


def _cost(seen: Arrays) -> list[str]:
    frames, drawing, clearing, left_open, _, unkept = seen["cost"]
    hints = []
    if clearing > SLOW * drawing and clearing > 1e-3 * frames:
        part = "more than half" if clearing > drawing / 2 else "about a third"
        hints.append(
            f"clearing the axes takes {part} of the drawing time: keep the artists and set their data instead"
        )
    if left_open:
        hints.append(
            "the figure stays open, so a notebook shows an extra still: call plt.close(fig) before you return"
        )
    if unkept:
        hints.append(
            "the sandbox has no files: your function stopped at one, so the animation it had made was graded"
        )
    return hints
