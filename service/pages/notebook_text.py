"""Markdown as text to read on a page: an assignment's notebook, without running it, and comments."""

import json
import re
from dataclasses import dataclass

from markupsafe import Markup, escape

from service.http.templating import neutralize_bidi

HEADING = re.compile(r"(#{1,6}) +(.+)")
SPAN = re.compile(
    r"`(?P<code>[^`\n]+)`"
    r"|(?<![*\w])\*\*(?P<b>[^*\n]+)\*\*(?![*\w])"
    r"|(?<![*\w])\*(?P<i>[^*\n]+)\*(?![*\w])"
)
"""Code, which contains no other span, bold and italic words: each group is named by its element of HTML."""


@dataclass(frozen=True)
class Block:
    """A part of a notebook: its ``kind``, "heading", "text" or "code", and its text, as HTML unless it is
    code.
    """

    kind: str
    text: Markup | str


def blocks(notebook: str) -> list[Block]:
    """Return the cells of a notebook, JSON text, as blocks: a cell of text has one for each heading and for
    what stands between; formulas stay TeX.
    """
    found = []
    for cell in json.loads(notebook)["cells"]:
        source = "".join(cell["source"]).strip("\n")
        if cell["cell_type"] == "code":
            found.append(Block("code", source))
        elif cell["cell_type"] == "markdown":
            found += _text(source)
    return [block for block in found if block.text]


def _text(source: str) -> list[Block]:
    found, paragraph = [], list[str]()
    for line in [*source.split("\n"), "# "]:
        heading = HEADING.fullmatch(line.rstrip())
        if heading or line == "# ":
            found.append(Block("text", inline("\n".join(paragraph).strip("\n"))))
            paragraph = []
        if heading:
            found.append(Block("heading", inline(heading[2])))
        else:
            paragraph.append(line)
    return found


def inline(text: str) -> Markup:
    """Return the text escaped, with code, bold and italic words as HTML; formulas stay TeX."""
    shown = str(escape(neutralize_bidi(text)))
    shown = SPAN.sub(_element, shown)
    return Markup(shown)  # noqa: S704


def _element(found: re.Match[str]) -> str:
    name = str(found.lastgroup)
    return f"<{name}>{found[name]}</{name}>"
