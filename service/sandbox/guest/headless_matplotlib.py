"""matplotlib without a screen and without LaTeX: every backend that a submission names draws with Agg, and
text for LaTeX is drawn by mathtext.

A window and what waits for a person do nothing.
"""

import types
from collections.abc import Callable
from typing import Any

import matplotlib
from matplotlib import backend_bases, pyplot
from matplotlib._pylab_helpers import Gcf
from matplotlib.backend_bases import FigureCanvasBase, FigureManagerBase, NavigationToolbar2
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.registry import backend_registry
from matplotlib.mathtext import MathTextParser
from matplotlib.text import Text

from .null_object import NOTHING

FILE_BACKENDS = ("pdf", "ps", "svg", "template")  # they need no screen and no other program
NO_LATEX = "the grader has no LaTeX: text is drawn by matplotlib's mathtext"
MARKUP = str.maketrans(dict.fromkeys("$\\{}"))


class Toolbar(NavigationToolbar2):
    """The toolbar of a window that is not there."""


class Manager(FigureManagerBase):
    """The window of a figure, whose widgets do nothing."""

    _toolbar2_class = Toolbar
    window = frame = NOTHING

    @classmethod
    def pyplot_show(cls, *, block: bool | None = None) -> None:
        """Close all figures: Jupyter does after it has shown them, and a person would. ``plt.pause`` shows
        them without waiting for that.
        """
        if block is not False:
            close_figures()

    def show(self) -> None:
        """Do nothing."""


class Canvas(FigureCanvasAgg):
    """A canvas that looks like that of a window. It is drawn when it is saved or drawn explicitly."""

    manager_class = Manager
    get_tk_widget = layout = parent = setFocus = setFocusPolicy = window = NOTHING
    print_pgf = FigureCanvasAgg.print_png

    def draw_idle(self, *args: Any, **kwargs: Any) -> None:
        """Do nothing: nobody looks."""


BACKEND = types.ModuleType("grader_backend")
BACKEND.FigureCanvas, BACKEND.FigureManager = Canvas, Manager  # type: ignore[attr-defined]

_load_file_backend: Callable[[str], types.ModuleType] = backend_registry.load_backend_module
_print_figure = FigureCanvasBase.print_figure
_parse = MathTextParser.parse
_open_figures = Gcf.figs
_set_usetex = Text.set_usetex
_said: list[str] = []


def close_figures() -> None:
    """Let pyplot draw on none of the figures any more. They keep their canvases, on which code can draw."""
    _open_figures.clear()


def install() -> None:
    """Change matplotlib in this process."""
    for owner, name, function in (
        (backend_registry, "load_backend_module", _load_backend),
        (backend_registry, "is_valid_backend", lambda backend: True),
        (backend_registry, "resolve_backend", lambda backend: (backend or "agg", None)),
        (FigureCanvasBase, "start_event_loop", _end_at_once),
        (FigureCanvasBase, "print_figure", _print_by_format),
        (Text, "set_usetex", _set_mathtext),
        (MathTextParser, "parse", _parse_or_plain),
    ):
        setattr(owner, name, function)
    matplotlib.rcParams.validate["text.usetex"] = _without_latex
    backend_bases.register_backend("pgf", Canvas)
    pyplot.switch_backend("agg")


def _load_backend(backend: str) -> types.ModuleType:
    return _load_file_backend(backend) if backend.lower() in FILE_BACKENDS else BACKEND


def _end_at_once(canvas: FigureCanvasBase, timeout: float = 0) -> None:
    """Do not wait: no event can come."""


def _print_by_format(canvas: FigureCanvasBase, *args: Any, backend: str | None = None, **kwargs: Any) -> Any:
    """Save a figure by the usual backend of its format: another one may need a program."""
    return _print_figure(canvas, *args, **kwargs)


def _without_latex(value: Any) -> bool:
    """Return False, and say so if LaTeX is asked for."""
    if matplotlib.rcsetup.validate_bool(value) and not _said:
        _said.append(NO_LATEX)
        print(NO_LATEX)
    return False


def _set_mathtext(text: Text, usetex: bool | None) -> None:
    _set_usetex(text, None if usetex is None else _without_latex(usetex))


def _parse_or_plain(parser: Any, s: str, *args: Any, **kwargs: Any) -> Any:
    """Parse a text. One for LaTeX that mathtext does not understand is taken without its markup."""
    try:
        return _parse(parser, s, *args, **kwargs)
    except ValueError:
        if not _said:
            raise
        return _parse(parser, s.translate(MARKUP), *args, **kwargs)
