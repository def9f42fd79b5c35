"""Markdown with formulas as HTML: the text of an assignment's notebook, and comments."""

import html
import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Any
from xml.etree import ElementTree

from markdown_it import MarkdownIt
from markdown_it.renderer import RendererHTML
from markdown_it.rules_inline import StateInline
from markdown_it.token import Token
from markupsafe import Markup
from mdit_py_plugins.dollarmath import dollarmath_plugin

from service.http.templating import neutralize_bidi

LONGEST_FORMULA = 500  # characters; a longer one stays TeX
STARS_IN_WORD = re.compile(r"(?<=\w)\*+(?=\w)")
NEVER_SHOWN = ("href", "style", "class")  # attributes that TeX could give to an element


@dataclass(frozen=True)
class NotebookCell:
    """A cell of a notebook: its text as HTML, or, with ``is_code``, its source."""

    text: Markup | str
    is_code: bool


def cells(notebook: str | bytes) -> list[NotebookCell]:
    """Return the cells of text and code of a notebook, JSON text. A heading of level 1 becomes an ``h2``."""
    found = []
    for cell in json.loads(notebook)["cells"]:
        source = "".join(cell["source"]).strip("\n")
        if cell["cell_type"] == "code":
            found.append(NotebookCell(source, is_code=True))
        elif cell["cell_type"] == "markdown":
            found.append(NotebookCell(_as_html(source), is_code=False))
    return [cell for cell in found if cell.text]


def inline(text: str) -> Markup:
    """Return a text as HTML without paragraphs, headings and lists. HTML in it stays text."""
    return Markup(_parser().renderInline(neutralize_bidi(text)))  # noqa: S704


def _as_html(text: str) -> Markup:
    parser = _parser()
    tokens = parser.parse(neutralize_bidi(text))
    for token in tokens:
        if token.type in ("heading_open", "heading_close"):
            token.tag = f"h{min(int(token.tag[1:]) + 1, 6)}"
    return Markup(parser.renderer.render(tokens, parser.options, {}))  # noqa: S704


@cache
def _parser() -> MarkdownIt:
    parser = MarkdownIt("commonmark", {"html": False}).enable("table")
    parser.inline.ruler.before("emphasis", "stars in a word", _stars_in_word)
    parser.add_render_rule("image", _alternative_text)
    dollarmath_plugin(
        parser,
        allow_labels=False,
        allow_space=False,
        double_inline=True,
        renderer=lambda tex, options: formula(tex, is_block=options["display_mode"]),
    )
    return parser


def _stars_in_word(state: StateInline, silent: bool) -> bool:
    """Take stars inside a word as text, so that ``2*a**2 + 3*b`` stays what it is."""
    found = STARS_IN_WORD.match(state.src, state.pos)
    if found is None:
        return False
    if not silent:
        state.pending += found[0]
    state.pos = found.end()
    return True


def _alternative_text(
    renderer: RendererHTML, tokens: Sequence[Token], index: int, options: Any, environment: Any
) -> str:
    return renderer.renderInlineAsText(tokens[index].children, options, environment)


@lru_cache(maxsize=2000)
def formula(tex: str, *, is_block: bool) -> str:
    """Return a formula in TeX as MathML, or what cannot be converted as TeX."""
    # latex2mathml reads its 0.2 MB of symbols when it is imported
    from latex2mathml.converter import convert_to_element

    shown = html.escape(f"$${tex}$$" if is_block else f"${tex}$")
    if len(tex) > LONGEST_FORMULA:
        return shown
    try:
        root = convert_to_element(tex, display="block" if is_block else "inline")
    except Exception:  # its errors have no common class, and a formula with mistakes is no reason to fail
        return shown
    for element in root.iter():
        element.text = html.unescape(element.text or "")  # ∂ is "&#x02202;"
        for name in NEVER_SHOWN:
            element.attrib.pop(name, None)
    if is_block:
        root.set("tabindex", "0")  # who uses the keyboard can scroll a wide one
    return ElementTree.tostring(root, encoding="unicode")
