"""Workflow commands read back by the runner's own rules: no text of a student's starts one."""

import pytest
from hypothesis import example as with_example
from hypothesis import given
from hypothesis import strategies as st
from markdown_it import MarkdownIt

from polhode.judging.outcome import Diagnosis, Picture
from service.formats.check_text import one_line, sanitize
from service.formats.github import MOST, MOST_BYTES, Annotation, annotations, escape_commands, summary
from tests.support.random_reports import HOSTILE, TEXTS
from tests.support.reports import example, graded_file, outcome, report
from tests.support.workflow_log import commands

TOKEN = "f3a9c1"


def test_a_command_to_the_letter():
    one = Annotation("exercise 2: euler_eqs, 50%", "a: b, 100%\nc%0A", "we:ird,dir/a%3A.py", 7)
    assert (
        str(one)
        == "::error file=we%3Aird%2Cdir/a%253A.py,line=7,title=exercise 2%3A euler_eqs%2C 50%25::a: b,"
        " 100%25%0Ac%250A"
    )
    assert str(Annotation("polhode", "x")) == "::error title=polhode::x"


@given(TEXTS, TEXTS, TEXTS, st.integers(1, 10**6))
@with_example("::add-mask::x", "\n::stop-commands::x", "a\r\n##[add-mask]b", 1)
def test_it_is_one_line_and_comes_back_whole(title, message, file, line):
    told = Annotation(one_line(f"T{title}"), sanitize(message), one_line(f"F{file}"), line)
    about = {"file": one_line(f"F{file}"), "line": str(line), "title": one_line(f"T{title}")}
    assert commands(str(told)) == [("error", about, sanitize(message))] and len(str(told).splitlines()) == 1


@given(st.lists(TEXTS, max_size=4).map("\n".join))
@with_example("::stop-commands::f3a9c2\n::f3a9c2::\n::add-mask::x")
@with_example("  ::error::x")
@with_example("✗  a ##[add-mask]x]   [b]")
def test_what_is_unheard_starts_no_command_and_ends_where_it_ends(text):
    assert commands(escape_commands(text, TOKEN) + "\n::error title=T::after") == [
        ("error", {"title": "T"}, "after")
    ]


def test_without_it_text_would():
    """Else the tests above could not fail."""
    assert [
        name for name, _, _ in commands("✗  a   [##[add-mask]x]\n   ::add-mask::y\n::stop-commands::z")
    ] == ["add-mask"] * 2


SOURCE = "def euler_eqs(t, w, I):\n    return w\n\ndef principal_moments(tensor):\n    return 0\n"
TAGS = (
    "<h",
    "<tr>",
    "<td>",
    "<p>",
    "<pre>",
    "<details>",
    "</details>",
    "<img",
    "<a ",
    "<ul>",
    "<!--",
    "<em>",
    "<strong>",
)
SLIP = Diagnosis("sign-flipped", "ω̇₂ has the opposite sign", 1.0)


def failed(id, *causes, label=""):
    return outcome(id, "fail", label, diagnosis=list(causes))


def read(files, rigid_body):
    return [(about, data) for _, about, data in commands("\n".join(annotations(files, rigid_body)))]


def test_checks_of_one_function_and_one_cause_are_one_annotation(rigid_body):
    lone, slips = failed("1-notebook"), [failed(id, SLIP) for id in ("2-energy", "2-momentum", "2-motion")]
    told = read([graded_file(report([lone], slips, [outcome("4-rate")]), source=SOURCE)], rigid_body)
    assert [about for about, _ in told] == [
        {"file": "samples/ann.py", "line": "1", "title": "exercise 2: euler_eqs (3 checks)"},
        {"file": "samples/ann.py", "line": "4", "title": "exercise 1: principal_moments"},
    ]
    assert (
        told[0][1]
        == "✗  2-energy   [got 2 vs expected 1]\n     likely sign-flipped: ω̇₂ has the opposite sign\n"
        "     allowed: the notebook's own tolerance\n\n"
        "also 2 more checks:\n✗  2-momentum   [got 2 vs expected 1]\n✗  2-motion   [got 2 vs expected 1]"
    )


def test_of_many_files_each_has_its_largest_first_and_the_rest_is_counted(rigid_body):
    two_kinds = report([failed("1-notebook")], [failed("2-energy", SLIP), failed("2-motion", SLIP)])
    told = read([graded_file(two_kinds, f"{name}.py", source=SOURCE) for name in "abcdefgh"], rigid_body)
    assert len(told) == MOST
    assert [about["file"] for about, _ in told[:-1]] == [f"{name}.py" for name in "abcdefgha"]
    assert all("euler_eqs" in about["title"] for about, _ in told[:8])
    assert told[-1] == (
        {"title": "polhode"},
        "and 7 more: GitHub shows 10 per step, the report lists all of them",
    )


def test_exactly_as_many_as_are_shown_are_told_all(rigid_body):
    told = read([graded_file(report([failed("2-energy")]), f"{k}.py") for k in range(MOST)], rigid_body)
    assert [about["file"] for about, _ in told] == [f"{k}.py" for k in range(MOST)]


def test_a_file_that_was_not_graded_has_one_too(rigid_body):
    told = read(
        [
            graded_file(None, refused="no text"),
            graded_file(None, "b.py", fault="disk full"),
            graded_file(report(), "c.py"),
        ],
        rigid_body,
    )
    assert [(about["title"], data.split("\n")[0]) for about, data in told] == [
        ("no submission", "no text"),
        ("system fault: not graded", "disk full"),
        (
            "failed: at least one check was scored",
            "0 of 0 points (public checks: 0 of 0)",
        ),
    ]


def test_what_passed_or_does_not_count_is_not_told(rigid_body):
    assert (
        read(
            [graded_file(report([outcome("2-energy"), outcome("5-moves", "unmeasured", counted=False)]))],
            rigid_body,
        )
        == []
    )


def rendered(files, rigid_body, **more):
    return MarkdownIt("commonmark").enable("table").render(summary(files, rigid_body, **more))


def test_a_summary(rigid_body):
    drawn = report([outcome("2-energy")], figures=[Picture("omega", "1", "Angular velocity", "ω over time")])
    files = [
        graded_file(drawn, "b.py"),
        graded_file(example()),
        graded_file(None, "c.py", refused="no text"),
        graded_file(None, "d.py", fault="disk full"),
    ]
    page = rendered(files, rigid_body)
    assert "<p>4 files: 1 all ✓, 1 not all ✓, 1 no submission, 1 not graded</p>" in page
    for cells in (
        ["b.py", "✓", "1 of 1", ""],
        ["samples/ann.py", "✗", "1 of 3", "<code>sign-flipped</code>"],
        ["c.py", "–", "no submission", ""],
        ["d.py", "!", "system fault", ""],
    ):
        cells[0] = f"<code>{cells[0]}</code>"
        assert "".join(f"<td>{cell}</td>\n" for cell in cells) in page
    assert "<li><strong>Angular velocity</strong>: ω over time</li>" in page
    assert (
        "✗  euler_eqs agrees with Euler's equations   [got 2 vs expected 1]\n     worst at ω̇₂ at question 3"
        in page
    )
    assert page.index("disk full") < page.index("✓  2-energy")  # what needs somebody comes first


def test_nothing_breaks_out_of_a_summary(rigid_body):
    plain = rendered([graded_file(report([failed("2-energy", label="x")]))], rigid_body)
    for evil in HOSTILE:
        one = failed("2-energy", Diagnosis(f"a{evil}", evil, 1.0), label=f"x{evil}")
        page = rendered([graded_file(report([one]), f"samples/{evil}/ann.py")], rigid_body)
        for tag in TAGS:
            assert page.count(tag) == plain.count(tag), (evil, tag)


@pytest.mark.slow
def test_there_is_an_end_to_a_summary(rigid_body):
    many = report([failed(f"2-{k}", label="é" * 100) for k in range(300)])
    files = [graded_file(many, f"samples/{k}/" + "`" * 150 + ".py") for k in range(3000)]
    for most in (MOST_BYTES, 20_000, 3000):
        told = summary(files, rigid_body, most)
        assert most // 4 < len(told.encode()) <= most
        assert "more files are not listed" in told and "more files do not fit here" in told
        assert told.count("<details>") == told.count("</details>")
