"""Showing an animation as a player."""

from typing import Any

from polhode.animation import animate


def show(
    anim: Any, *, fps: int = 30, mode: str = "loop", frame_dpi: float = 90, embed_limit_mb: float = 60
) -> Any:
    """Display an animation as a player of ``fps`` frames a second, whose frames have ``frame_dpi`` dots an
    inch and together at most ``embed_limit_mb`` megabytes. ``mode`` is "loop", "once" or "reflect".
    """
    import matplotlib as mpl

    with mpl.rc_context({"savefig.dpi": frame_dpi, "animation.embed_limit": embed_limit_mb}):
        return animate.show(anim, fps=fps, default_mode=mode)
