"""Showing an animation: in a notebook as a player, elsewhere kept for whoever asks for the last one shown."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

shown: list[Any] = []
"""The last animation handed to :func:`show`; a grader reads it, a notebook never needs it."""
made: list[Any] = []
"""The animations made since a check began to watch."""
RENDERING = {"save": None, "to_jshtml": '<div class="animation"><img src=""></div>', "to_html5_video": "<video></video>"}
"""What rendering returns while a check watches: the same kind of text, without frames."""
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

    ``Animation.save``, ``to_jshtml`` and ``to_html5_video`` write nothing and return what RENDERING says. Animations are kept in
    :data:`made`.
    """
    from matplotlib.animation import Animation

    originals = {name: getattr(Animation, name) for name in (*RENDERING, "__init__")}

    def kept(text: str | None) -> Any:
        def keep(anim: Any, *args: Any, **kwargs: Any) -> str | None:
            shown[:] = [anim]
            return text

        return keep

    def make(anim: Any, *args: Any, **kwargs: Any) -> None:
        originals["__init__"](anim, *args, **kwargs)
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
