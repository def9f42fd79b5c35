"""Showing an animation: in a notebook as a player, elsewhere kept for whoever asks for the last one shown."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

shown: list[Any] = []
"""The last animation handed to :func:`show`; a grader reads it, a notebook never needs it."""
RENDERING = ("save", "to_jshtml", "to_html5_video")
_watchers: list[None] = []


def show(anim: Any) -> Any:
    """Display a matplotlib ``Animation`` as a JavaScript player: end a cell with it, or return it from your function.

    Outside IPython, and while a check watches, it returns ``anim`` itself.
    """
    shown[:] = [anim]
    if _watchers or not _in_ipython():
        return anim
    from IPython.display import HTML

    return HTML(anim.to_jshtml())


@contextmanager
def watched() -> Iterator[None]:
    """Within, what is shown, saved or made into a player is kept in :data:`shown` and not rendered: that takes too long.

    ``Animation.save``, ``to_jshtml`` and ``to_html5_video`` write nothing and return an empty string.
    """
    from matplotlib.animation import Animation

    rendering = {name: getattr(Animation, name) for name in RENDERING}

    def keep(anim: Any, *args: Any, **kwargs: Any) -> str:
        shown[:] = [anim]
        return ""

    for name in RENDERING:
        setattr(Animation, name, keep)
    _watchers.append(None)
    try:
        yield
    finally:
        _watchers.pop()
        for name, original in rendering.items():
            setattr(Animation, name, original)


def _in_ipython() -> bool:
    try:
        from IPython.core.interactiveshell import InteractiveShell
    except ImportError:
        return False
    return bool(InteractiveShell.initialized())
