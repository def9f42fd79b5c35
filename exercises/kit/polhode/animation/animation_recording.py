"""Recording a matplotlib animation: stills, the paths of what is drawn, and what drawing costs. Endless
animations are stopped.
"""

import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from operator import length_hint
from time import perf_counter, process_time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polhode.animation import animate
from polhode.animation.artist_points import Drawn, drawn, labelled, painted, unordered
from polhode.animation.draw_decoration_once import decorated_once
from polhode.animation.visible_changes import Visibility, differ
from polhode.judging.remarks import remark
from polhode.judging.return_value import WrongAnswer

FRAME_CAP = 600
SPREAD = np.array(
    [0.0, 0.23, 0.38, 0.64, 0.77, 1.0]
)  # of the stills; uneven, because a periodic motion must not look still
STILLS, POINTS = len(SPREAD), 256  # pictures recorded, points recorded per frame
WIDTH, HEIGHT = 480, 360
VISIBLE = 16  # of 255 levels of a colour
LOOKS = {
    k * (k + 1) // 2 for k in range(FRAME_CAP)
}  # frames to render if their number is unknown, or to see what no still shows


def unchanged() -> None:
    """Do nothing. In the sandbox this is a check that a submission has replaced nothing of the recorder."""


def record(draw: Callable[[], Any], seconds: float) -> dict[str, NDArray[Any]]:
    """Return what ``watch`` records of the animation that ``draw`` returns, alone or with other values, or
    else shows, saves or renders.

    ``cost`` (6,) ends with 1 if ``draw`` stopped at a file, which the sandbox does not have: the animation
    that it had made is recorded then. Raises WrongAnswer as ``watch`` does, and if matplotlib cannot draw
    what the animation consists of.
    """
    from matplotlib.animation import Animation

    animate.shown.clear()
    animate.made.clear()
    unkept, recorder, checked = False, watch, unchanged
    try:
        anim = draw()
    except Exception as error:
        if len(animate.made) != 1 or not _lacks_a_file(error):
            raise
        anim, unkept = animate.made[0], True
    if not isinstance(anim, Animation) and animate.shown:
        anim = animate.shown[-1]
    among = [one for one in anim if isinstance(one, Animation)] if isinstance(anim, list | tuple) else []
    if len(among) == 1:
        (anim,) = among
        remark("the function returns the animation among other values: return it alone")
    checked()
    try:
        seen = recorder(anim, seconds)
    except Exception as error:
        if isinstance(error, MemoryError) or not _is_of_matplotlib(error):
            raise
        raise WrongAnswer("raises", f"{type(error).__name__}: {error}"[:500]) from error
    return seen | {"cost": np.array([*seen["cost"], unkept])}


def _lacks_a_file(error: Exception) -> bool:
    """Return whether an animation failed because it wrote, rendered or read a file:
    its motion may be right.
    """
    if isinstance(error, OSError) or (isinstance(error, AssertionError) and animate.shown):
        return True
    frames = traceback.walk_tb(error.__traceback__)
    return any(frame.f_globals.get("__name__") == "matplotlib.animation" for frame, _ in frames)


def _is_of_matplotlib(error: Exception) -> bool:
    """Return whether matplotlib raised it while it drew, not polhode's code or the student's own."""
    modules = [str(frame.f_globals.get("__name__")) for frame, _ in traceback.walk_tb(error.__traceback__)]
    last = max(k for k, name in enumerate(modules) if name == __name__)
    return "__main__" not in modules and any(
        name.startswith("matplotlib.") for name in modules[last + 1 : last + 2]
    )


def watch(anim: Any, seconds: float) -> dict[str, NDArray[Any]]:
    """Draw every frame once, in order, because drawing may depend on earlier frames. Return

    - ``frames`` (k, h, w, 3) uint8: k ≤ STILLS stills, spread over all frames, within WIDTH × HEIGHT pixels
    - ``tracks`` (f, p, 3): the points of the visible artists in each of f ≤ FRAME_CAP frames, in data
      coordinates
    - ``owners`` (p, 3): for each point the artist's number, the dimensions of its axes (0: there is no point;
      negative for points without order) and their number
    - ``labels`` (k, 3): for each 2-D axes its number and the coordinates its labels name, see
      ``artists.labelled``
    - ``at`` (f, 3): for each frame its number, the value the animation calls it by (−1: none), and the number
      of frames
    - ``cost`` (5,): frames drawn, seconds drawing them, of these clearing axes, 1 if the figure stays open,
      and the number of images without points
    - ``visible`` (2,): the share of the pixels that change without any text, and the number of moving artists
      that no pixel shows, in some of the stills

    Raises WrongAnswer for something that is not an animation, for more than FRAME_CAP frames, and past
    ``seconds`` of CPU time.
    """
    from matplotlib import pyplot as plt
    from matplotlib.animation import Animation

    if not isinstance(anim, Animation):
        raise WrongAnswer(
            "no-animation", f"expected a matplotlib Animation, returned or shown; got {type(anim).__name__}"
        )
    deadline = process_time() + seconds
    figure = anim._fig  # type: ignore[attr-defined]
    listed = length_hint(getattr(anim, "_tee_from", ()))
    values, paths, pictures, drawing = [], [], {}, 0.0
    anim._blit, anim._draw_was_started = False, True  # type: ignore[attr-defined]
    with _borrowed(figure) as canvas, _clearing() as cleared, decorated_once():
        canvas.mpl_disconnect(anim._first_draw_id)  # type: ignore[attr-defined]
        anim._init_draw()  # type: ignore[attr-defined]
        visibility, sequence = Visibility(figure, canvas), anim.new_frame_seq()
        known = max(listed, length_hint(sequence))  # 0 for a generator
        chosen = {round(at) for at in SPREAD * (known - 1)} if known else LOOKS
        for number, frame in enumerate(sequence):
            if max(number + 1, known) > FRAME_CAP:
                raise WrongAnswer(
                    "too-many-frames",
                    f"the animation has more than {FRAME_CAP} frames: give it a finite frames=…",
                )
            if process_time() > deadline:
                raise WrongAnswer(
                    "timeout",
                    f"drawing stopped after {number} frames: {seconds:g} s of CPU time were allowed",
                )
            began = perf_counter()
            anim._draw_frame(frame)  # type: ignore[attr-defined]
            drawing += perf_counter() - began
            values.append(_number(frame))
            paths.append(drawn(figure))
            if number in chosen or (visibility.in_doubt and number in LOOKS):
                picture = _picture(figure, canvas)
                if visibility.in_doubt:
                    visibility.look(paths[-1])
                if number in chosen:
                    pictures[number] = picture
    if not values:
        raise WrongAnswer("no-animation", "the animation has no frames")
    at = [[number, value, len(values)] for number, value in enumerate(values)]
    paths, invisible = visibility.split(paths)
    tracks, owners = _tracks(paths)
    left_open = plt.fignum_exists(getattr(figure, "number", -1))
    cost = np.array([len(values), drawing, sum(cleared), left_open, painted(figure)], dtype=float)
    nearest = {min(pictures, key=lambda number: abs(number - at)) for at in SPREAD * (len(values) - 1)}
    stills = _stack([pictures[number] for number in sorted(nearest)])
    named = {
        "tracks": tracks,
        "owners": owners,
        "labels": labelled(figure),
        "visible": np.array([visibility.moves, invisible]),
    }
    return {"frames": stills, **named, "at": np.array(at, dtype=float), "cost": cost}


def moving_share(frames: NDArray[np.uint8]) -> float:
    """Return the largest share of pixels that differ visibly between the first still and another; ``frames``
    (n, h, w, 3).
    """
    if len(frames) < 2:
        return 0.0
    return float(differ(frames[1:], frames[0], VISIBLE).mean(axis=(1, 2)).max())


def _picture(figure: Any, canvas: Any) -> NDArray[np.uint8]:
    for part in (figure, *figure.axes):
        for artist in part.get_children():
            artist.set_animated(False)  # an ordinary draw skips artists that a submission marks for blitting
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())
    return np.array(pixels[:HEIGHT, :WIDTH, :3])


def _stack(pictures: list[NDArray[np.uint8]]) -> NDArray[np.uint8]:
    """Return one array of the part that all pictures have: a figure may change its size."""
    high, wide = (min(p.shape[k] for p in pictures) for k in (0, 1))
    return np.stack([p[:high, :wide] for p in pictures])


def _tracks(paths: list[list[Drawn]]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the points of the artists that are in every frame; if an artist's number of points changes, its
    first and last.

    Artists are identified by their order from the newest on, and where their number changes also from the
    oldest on.
    """
    newest = [{d.key: d for d in frame} for frame in paths]
    oldest = [{(*d.key[:2], -d.oldest): d for d in frame} for frame in paths]
    columns, owners, ranks = [], [], [0]
    for by_key in (newest, oldest):
        for key, first in by_key[0].items():
            seen = [frame[key] for frame in by_key if key in frame]
            if len(seen) < len(by_key) or (by_key is oldest and all(d.key == first.key for d in seen)):
                continue
            points = [d.points for d in seen]
            same = min(map(len, points)) == max(map(len, points))
            many = len(first.points) if same else min(2, *map(len, points))
            columns.append(np.stack([p[:many] for p in points]))
            owners += [[len(columns), first.dimensions, first.key[0]]] * many
            ranks += range(many)
    for (axes, _), sets in unordered(paths).items():
        columns.append(np.stack([d.points for d in sets]))
        many = columns[-1].shape[1]
        owners += [[len(columns), -sets[0].dimensions, axes]] * many
        ranks += range(many)
    tracks = np.concatenate([np.zeros((len(paths), 1, 3)), *columns], axis=1)
    owned = np.array([[0, 0, 0], *owners], dtype=float)
    tracks[:, ~np.all(np.isfinite(tracks) & (np.abs(tracks) < 1e100), axis=(0, 2))] = 0.0
    ends, moved = np.array(ranks) < 2, np.ptp(tracks, axis=0).max(axis=1)
    chosen = np.sort(
        np.lexsort((-moved, ~ends))[:POINTS]
    )  # the ends of every artist first, then moving before fixed points
    return tracks[:, chosen], owned[chosen]


@contextmanager
def _borrowed(figure: Any) -> Iterator[Any]:
    """Give the figure a canvas of limited size, and restore its own afterwards."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    own, dpi = figure.canvas, figure.dpi
    wide, high = figure.get_size_inches()
    if not min(wide, high) > 0:
        raise WrongAnswer("no-animation", "the figure has no pixels: give it a positive size")
    canvas = FigureCanvasAgg(figure)
    figure.set_dpi(min(WIDTH / wide, HEIGHT / high))
    try:
        yield canvas
    finally:
        figure.set_canvas(own)
        figure.set_dpi(dpi)


@contextmanager
def _clearing() -> Iterator[list[float]]:
    """Record the seconds spent in each clearing of axes."""
    from matplotlib.axes import Axes

    spent: list[float] = []
    clear = Axes._AxesBase__clear if hasattr(Axes, "_AxesBase__clear") else None
    if clear is None:
        yield spent
        return

    def timed(axes: Any) -> None:
        began = perf_counter()
        clear(axes)
        spent.append(perf_counter() - began)

    Axes._AxesBase__clear = timed  # type: ignore[attr-defined]
    try:
        yield spent
    finally:
        Axes._AxesBase__clear = clear  # type: ignore[attr-defined]


def _number(frame: Any) -> float:
    try:
        value = float(frame)
    except (TypeError, ValueError):
        return -1.0
    return value if np.isfinite(value) else -1.0
