"""Stills of a matplotlib animation: its own frame sequence, each still drawn once, endless ones stopped."""

import itertools
import time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ecp.strict import WrongAnswer

FRAME_CAP = 600
STILLS = 24
WIDTH, HEIGHT = 480, 360
VISIBLE = 16  # of 255 levels of a colour


def stills(anim: Any, seconds: float, at_most: int = STILLS) -> NDArray[np.uint8]:
    """RGB stills (k, h, w, 3), k ≤ ``at_most``, evenly spread over the animation's frames, within WIDTH × HEIGHT pixels.

    Every frame is computed in order, because drawing may depend on earlier ones, but only the stills are rasterised.
    Raises WrongAnswer for something that is not an animation, for more than FRAME_CAP frames, and past ``seconds``.
    """
    from matplotlib.animation import Animation
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    if not isinstance(anim, Animation):
        raise WrongAnswer("no-animation", f"expected a matplotlib Animation, returned or shown; got {type(anim).__name__}")
    deadline = time.monotonic() + seconds
    figure = anim._fig  # type: ignore[attr-defined]
    canvas = FigureCanvasAgg(figure)
    wide, high = figure.get_size_inches()
    figure.set_dpi(min(WIDTH / wide, HEIGHT / high))
    canvas.mpl_disconnect(anim._first_draw_id)  # type: ignore[attr-defined]
    anim._blit, anim._draw_was_started = False, True  # type: ignore[attr-defined]
    frames = _frames(anim)
    chosen = set(np.unique(np.linspace(0, len(frames) - 1, min(at_most, len(frames))).round().astype(int)).tolist())
    anim._init_draw()  # type: ignore[attr-defined]
    drawn = []
    for number, frame in enumerate(frames):
        if time.monotonic() > deadline:
            raise WrongAnswer("timeout", f"drawing stopped after {number} of {len(frames)} frames: {seconds:g} s were allowed")
        anim._draw_frame(frame)  # type: ignore[attr-defined]
        if number in chosen:
            for artist in figure.findobj(lambda artist: artist.get_animated()):
                artist.set_animated(False)  # blitting had marked it, and an ordinary draw leaves marked artists out
            canvas.draw()  # type: ignore[no-untyped-call]
            pixels = np.asarray(canvas.buffer_rgba())  # type: ignore[no-untyped-call]
            drawn.append(pixels[:HEIGHT, :WIDTH, :3].copy())
    return np.stack(drawn)


def moving_share(frames: NDArray[np.uint8]) -> float:
    """Largest share of pixels that differ visibly between the first still and another; ``frames`` (n, h, w, 3)."""
    if len(frames) < 2:
        return 0.0
    difference = np.abs(frames[1:].astype(np.int16) - frames[0].astype(np.int16)).max(axis=3)
    return float((difference > VISIBLE).mean(axis=(1, 2)).max())


def _frames(anim: Any) -> list[Any]:
    frames = list(itertools.islice(anim.new_frame_seq(), FRAME_CAP + 1))
    if not frames:
        raise WrongAnswer("no-animation", "the animation has no frames")
    if len(frames) > FRAME_CAP:
        raise WrongAnswer("too-many-frames", f"the animation has more than {FRAME_CAP} frames: give it a finite frames=…")
    return frames
