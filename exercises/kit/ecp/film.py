"""A matplotlib animation watched: stills, the paths of what is drawn, and what the drawing costs. Endless ones are stopped."""

import itertools
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ecp.strict import WrongAnswer
from ecp.tracks import Drawn, drawn

FRAME_CAP = 600
STILLS, FOLLOWED, POINTS = 24, 48, 256  # pictures kept, frames whose points are kept, points kept
WIDTH, HEIGHT = 480, 360
VISIBLE = 16  # of 255 levels of a colour


def watch(anim: Any, seconds: float) -> dict[str, NDArray[Any]]:
    """Draw every frame once, in order, because drawing may depend on earlier ones. Returns

    - ``frames`` (k, h, w, 3) uint8: k ≤ STILLS stills, evenly spread, within WIDTH × HEIGHT pixels
    - ``tracks`` (f, p, 3): where the artists put their points in f ≤ FOLLOWED frames, in data coordinates
    - ``owners`` (p, 2): for each point the artist's number and whether its axes have 2 or 3 dimensions (0: there is no point)
    - ``at`` (f, 3): for each of those frames its number, the value the animation calls it by (−1: none), and how many there are
    - ``cost`` (4,): frames drawn, seconds drawing them, of which in clearing axes, figures left open

    Raises WrongAnswer for something that is not an animation, for more than FRAME_CAP frames, and past ``seconds``.
    """
    from matplotlib import pyplot as plt
    from matplotlib.animation import Animation
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    if not isinstance(anim, Animation):
        raise WrongAnswer("no-animation", f"expected a matplotlib Animation, returned or shown; got {type(anim).__name__}")
    deadline = time.monotonic() + seconds
    figure = anim._fig  # type: ignore[attr-defined]
    left_open = len(plt.get_fignums())
    canvas = FigureCanvasAgg(figure)
    wide, high = figure.get_size_inches()
    figure.set_dpi(min(WIDTH / wide, HEIGHT / high))
    canvas.mpl_disconnect(anim._first_draw_id)  # type: ignore[attr-defined]
    anim._blit, anim._draw_was_started = False, True  # type: ignore[attr-defined]
    frames = _frames(anim)
    stills, followed = _spread(len(frames), STILLS), _spread(len(frames), FOLLOWED)
    pictures, paths, drawing = [], [], 0.0
    with _clearing() as cleared:
        anim._init_draw()  # type: ignore[attr-defined]
        for number, frame in enumerate(frames):
            if time.monotonic() > deadline:
                raise WrongAnswer("timeout", f"drawing stopped after {number} of {len(frames)} frames: {seconds:g} s were allowed")
            began = time.perf_counter()
            anim._draw_frame(frame)  # type: ignore[attr-defined]
            drawing += time.perf_counter() - began
            if number in followed:
                paths.append(drawn(figure))
            if number in stills:
                pictures.append(_picture(figure, canvas))
    at = [[number, _number(frames[number]), len(frames)] for number in sorted(followed)]
    tracks, owners = _tracks(paths)
    cost = np.array([len(frames), drawing, sum(cleared), left_open], dtype=float)
    return {"frames": np.stack(pictures), "tracks": tracks, "owners": owners, "at": np.array(at, dtype=float), "cost": cost}


def moving_share(frames: NDArray[np.uint8]) -> float:
    """Largest share of pixels that differ visibly between the first still and another; ``frames`` (n, h, w, 3)."""
    if len(frames) < 2:
        return 0.0
    difference = np.abs(frames[1:].astype(np.int16) - frames[0].astype(np.int16)).max(axis=3)
    return float((difference > VISIBLE).mean(axis=(1, 2)).max())


def _picture(figure: Any, canvas: Any) -> NDArray[np.uint8]:
    for artist in figure.findobj(lambda artist: artist.get_animated()):
        artist.set_animated(False)  # blitting had marked it, and an ordinary draw leaves marked artists out
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())
    return np.array(pixels[:HEIGHT, :WIDTH, :3])


def _tracks(paths: list[list[Drawn]]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The points of the artists that are there in every frame; of those whose number of points changes the first and the last."""
    by_key = [{d.key: d for d in frame} for frame in paths]
    columns, owners = [], []
    for number, first in enumerate(paths[0]):
        if not all(first.key in frame for frame in by_key):
            continue
        points = [frame[first.key].points for frame in by_key]
        same = min(map(len, points)) == max(map(len, points))
        many = len(first.points) if same else min(2, *map(len, points))
        if not many:
            continue
        columns.append(np.stack([p[:many] for p in points]))
        owners += [[number, first.dimensions]] * many
    if not columns:
        return np.zeros((len(paths), 1, 3)), np.zeros((1, 2))
    tracks = np.concatenate(columns, axis=1)[:, :POINTS]
    finite = np.all(np.isfinite(tracks) & (np.abs(tracks) < 1e100), axis=(0, 2))
    if not finite.any():
        return np.zeros((len(paths), 1, 3)), np.zeros((1, 2))
    return tracks[:, finite], np.array(owners[:POINTS], dtype=float)[finite]


@contextmanager
def _clearing() -> Iterator[list[float]]:
    """Seconds spent in each clearing of axes within."""
    from matplotlib.axes import Axes

    spent: list[float] = []
    clear = Axes._AxesBase__clear if hasattr(Axes, "_AxesBase__clear") else None
    if clear is None:
        yield spent
        return

    def timed(axes: Any) -> None:
        began = time.perf_counter()
        clear(axes)
        spent.append(time.perf_counter() - began)

    Axes._AxesBase__clear = timed  # type: ignore[attr-defined]
    try:
        yield spent
    finally:
        Axes._AxesBase__clear = clear  # type: ignore[attr-defined]


def _spread(n: int, most: int) -> set[int]:
    return set(np.unique(np.linspace(0, n - 1, min(most, n)).round().astype(int)).tolist())


def _number(frame: Any) -> float:
    try:
        value = float(frame)
    except (TypeError, ValueError):
        return -1.0
    return value if np.isfinite(value) else -1.0


def _frames(anim: Any) -> list[Any]:
    frames = list(itertools.islice(anim.new_frame_seq(), FRAME_CAP + 1))
    if not frames:
        raise WrongAnswer("no-animation", "the animation has no frames")
    if len(frames) > FRAME_CAP:
        raise WrongAnswer("too-many-frames", f"the animation has more than {FRAME_CAP} frames: give it a finite frames=…")
    return frames
