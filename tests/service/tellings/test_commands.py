"""Workflow commands read back by the runner's own rules: no text of a student's starts one."""

from hypothesis import example, given
from hypothesis import strategies as st

from service.tellings.commands import Annotation, unheard
from service.tellings.detail import one_line, shown
from tests.support.random_reports import TEXTS
from tests.support.workflow_log import commands

TOKEN = "f3a9c1"


def test_a_command_to_the_letter():
    one = Annotation("exercise 2: euler_eqs, 50%", "a: b, 100%\nc%0A", "we:ird,dir/a%3A.py", 7)
    assert str(one) == "::error file=we%3Aird%2Cdir/a%253A.py,line=7,title=exercise 2%3A euler_eqs%2C 50%25::a: b, 100%25%0Ac%250A"
    assert str(Annotation("polhode", "x")) == "::error title=polhode::x"


@given(TEXTS, TEXTS, TEXTS, st.integers(1, 10**6))
@example("::add-mask::x", "\n::stop-commands::x", "a\r\n##[add-mask]b", 1)
def test_it_is_one_line_and_comes_back_whole(title, message, file, line):
    told = Annotation(one_line(f"T{title}"), shown(message), one_line(f"F{file}"), line)
    about = {"file": one_line(f"F{file}"), "line": str(line), "title": one_line(f"T{title}")}
    assert commands(str(told)) == [("error", about, shown(message))] and len(str(told).splitlines()) == 1


@given(st.lists(TEXTS, max_size=4).map("\n".join))
@example("::stop-commands::f3a9c2\n::f3a9c2::\n::add-mask::x")
@example("  ::error::x")
@example("✗  a ##[add-mask]x]   [b]")
def test_what_is_unheard_starts_no_command_and_ends_where_it_ends(text):
    assert commands(unheard(text, TOKEN) + "\n::error title=T::after") == [("error", {"title": "T"}, "after")]


def test_without_it_text_would():
    """Else the tests above could not fail."""
    assert [name for name, _, _ in commands("✗  a   [##[add-mask]x]\n   ::add-mask::y\n::stop-commands::z")] == ["add-mask"] * 2
