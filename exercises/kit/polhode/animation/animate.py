"""Display an animation as a player; outside a notebook, record the last one shown."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

shown: list[Any] = []
"""The last animation passed to :func:`show`; a grader reads it, a notebook does not need it."""
made: list[Any] = []
"""The animations created inside :func:`watched`."""
RENDERING = {
    "save": None,
    "to_jshtml": '<div class="animation"><img src=""></div>',
    "to_html5_video": "<video></video>",
}
"""What rendering returns inside :func:`watched`: the same kind of text, without frames."""
_watchers: list[None] = []


def show(anim: Any, **player: Any) -> Any:
    """Display a matplotlib ``Animation`` as a JavaScript player, with these arguments of ``to_jshtml``. End a
    cell with it, or return it from your function.

    Returns ``anim`` itself outside IPython and inside :func:`watched`.
    """
    shown[:] = [anim]
    if _watchers or not _in_ipython():
        return anim
    from IPython.display import HTML

    return HTML(anim.to_jshtml(**player))


@contextmanager
def watched() -> Iterator[None]:
    """Record animations that are shown, saved or made into a player in :data:`shown`, without the slow
    rendering.

    ``Animation.save``, ``to_jshtml`` and ``to_html5_video`` write nothing and return what RENDERING has.
    Animations that are created are recorded in :data:`made`.
    """
    from matplotlib.animation import Animation

    from polhode.animation.draw_decoration_once import undecorated

    originals = {name: getattr(Animation, name) for name in (*RENDERING, "__init__")}

    def kept(text: str | None) -> Any:
        def keep(anim: Any, *args: Any, **kwargs: Any) -> str | None:
            shown[:] = [anim]
            return text

        return keep

    def make(anim: Any, *args: Any, **kwargs: Any) -> None:
        with undecorated():  # blitting draws once
            originals["__init__"](anim, *args, **kwargs)
        anim._draw_was_started = (
            True  # or matplotlib warns when it is deleted, although no window shows it here
        )
        made.append(anim)

    for name, text in RENDERING.items():
        setattr(Animation, name, kept(text))
    Animation.__init__ = make  # type: ignore[method-assign, assignment]
    _watchers.append(None)
    try:
        yield
    finally:
        _watchers.pop()
        made.clear()
        for name, original in originals.items():
            setattr(Animation, name, original)


def _in_ipython() -> bool:
    try:
        from IPython.core.interactiveshell import InteractiveShell
    except ImportError:
        return False
    return bool(InteractiveShell.initialized())
