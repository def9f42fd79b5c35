"""A notebook as text to read: headings, paragraphs and code, all of it escaped."""

import json

import pytest

from exercises.authoring.assignments.catalogue import assignments
from service.pages.notebook_text import Block, blocks, inline


def cell(kind, source):
    return {"cell_type": kind, "source": source}


def read(*cells):
    return blocks(json.dumps({"cells": cells}))


def test_cells_are_headings_text_and_code():
    text = "# Title\n\nSome `code`, **bold** and *italic*: $a < b$.\n- one\n## Part\nmore"
    assert read(cell("markdown", text), cell("code", ["x = 1\n", "y < 2"]), cell("raw", "no")) == [
        Block("heading", "Title"),
        Block("text", "Some <code>code</code>, <b>bold</b> and <i>italic</i>: $a &lt; b$.\n- one"),
        Block("heading", "Part"),
        Block("text", "more"),
        Block("code", "x = 1\ny < 2"),
    ]


def test_markup_stays_text():
    (block,) = read(cell("markdown", "<script>alert(1)</script> `<b>`"))
    assert block.text == "&lt;script&gt;alert(1)&lt;/script&gt; <code>&lt;b&gt;</code>"


def test_a_comment_has_markdown_and_its_markup_stays_text():
    assert inline("**see** `w[0]` and $\\omega$ <b>") == (
        "<b>see</b> <code>w[0]</code> and $\\omega$ &lt;b&gt;"
    )
    assert "\u202e" not in inline("a\u202eb")


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("`x**2 + y**2`", "<code>x**2 + y**2</code>"),
        ("`**kwargs` and `**more`", "<code>**kwargs</code> and <code>**more</code>"),
        ("a**2 + b**2", "a**2 + b**2"),
        ("2*a and 3*b", "2*a and 3*b"),
        ("*slow* and **fast**", "<i>slow</i> and <b>fast</b>"),
    ],
)
def test_the_stars_of_code_stay_stars(text, shown):
    assert inline(text) == shown


def test_every_notebook_can_be_read():
    for assignment in assignments().values():
        found = blocks(assignment.notebook())
        assert {"heading", "text", "code"} == {block.kind for block in found}, assignment.slug
