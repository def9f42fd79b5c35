"""Markdown with formulas as HTML: text and code of a notebook, and comments; what people write stays text."""

import json
import random
from xml.etree import ElementTree

import pytest
from latex2mathml import commands

from exercises.authoring.assignments.catalogue import assignments
from service.pages import markdown
from service.pages.markdown import NotebookCell, formula, inline
from tests.support.database import entered
from tests.support.http_client import Browser

OMEGA = "<mi>ω</mi>"


def cell(kind, source):
    return {"cell_type": kind, "source": source}


def read(*cells):
    return markdown.cells(json.dumps({"cells": cells}))


def test_cells_are_text_and_code():
    text = "# Title\n\nSome `code`, **bold** and *italic*: $\\omega$.\n- one\n## Part\nmore"
    shown, code = read(cell("markdown", text), cell("code", ["x = 1\n", "y < 2"]), cell("raw", "no"))
    assert code == NotebookCell("x = 1\ny < 2", is_code=True)
    assert not shown.is_code and OMEGA in shown.text
    for part in (
        "<h2>Title</h2>",
        "<code>code</code>",
        "<strong>bold</strong>",
        "<em>italic</em>",
        "<li>one</li>",
        "<h3>Part</h3>",
    ):
        assert part in shown.text


@pytest.mark.parametrize("text", ["$$\\omega$$", "where\n$$\\omega\n= 1$$\nand"])
def test_a_displayed_formula(text):
    (shown,) = read(cell("markdown", text))
    assert OMEGA in shown.text and 'display="block"' in shown.text and "$" not in shown.text


def test_a_notebook_on_its_page_has_the_addresses_of_the_server(server, url):
    browser = Browser(server).log_in(token=entered(url, "ann"))
    status, shown = browser.open("/assignments/rigid-body/notebook")
    assert status == 200 and "{{" not in shown and f"{server.url}/kit/" in shown


def test_markup_stays_text():
    (shown,) = read(cell("markdown", "<script>alert(1)</script> `<b>` ![a figure](https://x.example/y.png)"))
    assert "&lt;script&gt;alert(1)&lt;/script&gt; <code>&lt;b&gt;</code> a figure" in shown.text


def test_a_comment_has_markdown_and_formulas_and_its_markup_stays_text():
    shown = inline("**see** `w[0]` and $\\omega$ <b>")
    assert shown.startswith("<strong>see</strong> <code>w[0]</code> and <span") and OMEGA in shown
    assert shown.endswith(" &lt;b&gt;") and "\u202e" not in inline("a\u202eb")
    assert "<a" not in inline("[x](javascript:alert(1))")


@pytest.mark.parametrize(
    ("tex", "shown"),
    [
        (r"\frac{", r"$\frac{$"),
        (r"\left(<b>", r"$\left(&lt;b&gt;$"),
        ("x" * 501, f"${'x' * 501}$"),
    ],
)
def test_a_formula_that_cannot_be_shown_stays_tex(tex, shown):
    assert formula(tex, is_block=False) == shown


def test_a_formula_contains_nothing_but_mathematics():
    """Random formulas of every command: well-formed, without links, styles and other elements."""
    rng = random.Random(1)
    known = [one for one in vars(commands).values() if isinstance(one, str) and one.startswith("\\")]
    parts = [*known, *"{}[]^_&<>'\"ab12+= ", "{javascript:a}", r"\text{<script>}", "&lt;script&gt;"]
    converted = 0
    for _ in range(3000):
        shown = formula("".join(rng.choices(parts, k=rng.randint(1, 20))), is_block=False)
        if not shown.startswith("<math"):
            assert "<" not in shown
            continue
        converted += 1
        for element in ElementTree.fromstring(shown).iter():
            assert element.tag.startswith("{http://www.w3.org/1998/Math/MathML}m")
            assert not {"href", "style", "class"} & element.attrib.keys()
            assert not any(name.startswith("on") for name in element.attrib)
    assert converted > 300


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("`x**2 + y**2`", "<code>x**2 + y**2</code>"),
        ("`**kwargs` and `**more`", "<code>**kwargs</code> and <code>**more</code>"),
        ("a**2 + b**2", "a**2 + b**2"),
        ("2*a and 3*b", "2*a and 3*b"),
        ("*slow* and **fast**", "<em>slow</em> and <strong>fast</strong>"),
    ],
)
def test_the_stars_of_code_stay_stars(text, shown):
    assert inline(text) == shown


def test_every_notebook_can_be_read():
    for assignment in assignments().values():
        found = markdown.cells(assignment.notebook())
        text = "".join(shown.text for shown in found if not shown.is_code)
        assert "<h2>" in text and "<math" in text and "$" not in text, assignment.slug
        assert any(shown.is_code for shown in found)
