"""The look of a course notebook in our own course package."""

import importlib
import sys

import matplotlib as mpl
import pytest

from tests.support.checkout import ROOT


@pytest.fixture
def style(monkeypatch):
    monkeypatch.setattr(sys, "path", [*sys.path, str(ROOT / "exercises/rigid_body/course")])
    yield importlib.import_module("ecp.style")
    for name in [name for name in sys.modules if name.partition(".")[0] == "ecp"]:
        del sys.modules[name]


def test_header_style_and_footer_print_nothing_outside_a_notebook(style, capsys):

    with mpl.rc_context():
        assert style.use_style() is None
        assert mpl.rcParams["axes.spines.top"] is False
    given = {
        "volume": "II",
        "number": 2.6,
        "title": "A <b>",
        "blurb": "…",
        "difficulty": "advanced",
        "estimate": "90 min",
    }
    assert style.header(**given) is None and style.footer() is None
    assert capsys.readouterr() == ("", "")


def test_the_header_displays_its_texts_escaped(style, monkeypatch):
    shown = []
    monkeypatch.setattr(style, "_display", shown.append)
    style.header(volume="II", number="2.6", title="Tops & <script>", difficulty="advanced", optional=True)
    assert (
        "II · Notebook 2.6 · optional" in shown[0]
        and "Tops &amp; &lt;script&gt;" in shown[0]
        and "Level: advanced" in shown[0]
    )


def test_an_animation_is_shown_as_the_course_shows_it(style, monkeypatch):
    animate, draw = (importlib.import_module(f"ecp.{name}") for name in ("animate", "draw"))
    monkeypatch.setattr("polhode.animation.animate._in_ipython", lambda: True)

    class Film:
        def to_jshtml(self, **given):
            given |= {"dpi": mpl.rcParams["savefig.dpi"], "most": mpl.rcParams["animation.embed_limit"]}
            return str(sorted(given.items()))

    shown = animate.show(Film(), fps=20, mode="once", frame_dpi=50)
    assert shown.data == "[('default_mode', 'once'), ('dpi', 50.0), ('fps', 20), ('most', 60.0)]"
    assert len({draw.INK, draw.ACCENT, draw.SOFT}) == 3
