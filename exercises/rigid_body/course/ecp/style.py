"""The look of a course notebook: header and footer, displayed in notebook front ends only, and one style for
figures.
"""

from html import escape
from typing import Any

AMBER, QUIET = "#c0851a", "#5d6785"
_CARD = (
    f"border-left:.3em solid {AMBER};padding:.4em 0 .4em 1em;margin:.5em"
    " 0;font-family:system-ui,sans-serif;line-height:1.4"
)


def header(
    *,
    volume: Any = "",
    number: Any = "",
    title: Any = "",
    blurb: Any = "",
    difficulty: Any = "",
    estimate: Any = "",
    optional: bool = False,
) -> None:
    """Display the notebook's title card: volume and number, title, one sentence on its topic, level and
    estimated time, and whether it is optional.
    """
    parts = (volume, f"Notebook {number}" if number else "", "optional" if optional else "")
    place = " · ".join(escape(str(part)) for part in parts if part)
    efforts = {"Level": difficulty, "Estimate": estimate}
    effort = " · ".join(f"{name}: {escape(str(value))}" for name, value in efforts.items() if value)
    rows = [
        f'<div style="color:{QUIET};font-size:.9em">{place}</div>',
        f'<div style="font-size:1.6em;font-weight:600">{escape(str(title))}</div>',
        f"<div>{escape(str(blurb))}</div>",
        f'<div style="color:{QUIET};font-size:.9em">{effort}</div>',
    ]
    _display(f'<div style="{_CARD}">{"".join(rows)}</div>')


def footer() -> None:
    """Display the closing card, with a reminder to restart and run all cells before submitting."""
    text = "End of the notebook. Restart the kernel and run all cells once before you submit it."
    _display(f'<div style="{_CARD};color:{QUIET};font-size:.9em">{text}</div>')


def use_style() -> None:
    """Set matplotlib's defaults: colours distinguishable with colour blindness, light axes, animations as
    players.
    """
    import matplotlib.pyplot as plt
    from cycler import cycler

    plt.rcParams.update(
        {
            "animation.html": "jshtml",
            "axes.edgecolor": QUIET,
            "axes.grid": True,
            "axes.prop_cycle": cycler(color=["#0072b2", "#e69f00", "#c1272d", "#009e73", "#7b86a6", AMBER]),
            "axes.spines.right": False,
            "axes.spines.top": False,
            "axes.titlesize": "medium",
            "grid.alpha": 0.3,
            "legend.frameon": False,
        }
    )


def _display(html: str) -> None:
    try:
        from IPython import get_ipython
        from IPython.display import HTML, display
    except ImportError:
        return
    if get_ipython() is not None:
        display(HTML(html))
