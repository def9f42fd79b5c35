"""Titles of notebooks and exercises as plain text, from headings in Markdown with LaTeX."""

import ast
import re
import unicodedata
from collections.abc import Sequence

from exercises.authoring.questions.author_notebook import NUMBER, SEPARATOR, Cell

MOST_TITLE = 100  # characters
LINK = re.compile(r"!?\[([^\]]*)\]\([^)]*\)")
ROLE = re.compile(r"\{\w+\}`([^`]*)`")
EMPHASIS = re.compile(r"(\*\*|__|\*|`|~~)(\S(?:.*?\S)?)\1")
MATHEMATICS = re.compile(r"\$+([^$]+)\$+")
COMMAND = re.compile(r"\\([a-zA-Z]+)")
SIGNS = {"cdot": "·", "times": "×", "to": "→", "rightarrow": "→", "infty": "∞", "hbar": "ħ", "sqrt": "√",
         "pm": "±", "leq": "≤", "le": "≤", "geq": "≥", "ge": "≥", "neq": "≠", "ne": "≠", "approx": "≈",
         "propto": "∝", "nabla": "∇", "partial": "∂", "sum": "∑", "int": "∫", "langle": "⟨", "rangle": "⟩",
         "dagger": "†", "ell": "ℓ", "sim": "∼", "equiv": "≡"}  # fmt: skip


def notebook_title(cells: Sequence[Cell]) -> str:
    """Return the title of the course's ``header(number=…, title=…)``, else the first heading."""
    for node in (node for cell in cells for node in cell.nodes):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "header":
            given = {k.arg: k.value.value for k in node.keywords if isinstance(k.value, ast.Constant)}
            if given.get("title"):
                return plain(" ".join(str(given[name]) for name in ("number", "title") if given.get(name)))
    return plain(next((text for cell in cells for _, text in cell.headings), ""))


def exercise_heading(heading: str) -> tuple[str, str]:
    """Return the number of a heading such as "Exercise 2 — The pendulum", "" without one, and its title."""
    match = re.match(rf"(?:exercise\s+)?({NUMBER.pattern})(?!\w){SEPARATOR}(.*)", heading, re.IGNORECASE)
    return (match[1], plain(match[match.re.groups])) if match else ("", plain(heading))


def plain(text: str) -> str:
    """Return a heading as one line of plain text, at most MOST_TITLE characters long.

    >>> plain("**Modes** of [a chain](x.md): $\\\\omega_k \\\\to 0$")
    'Modes of a chain: ω_k → 0'
    """
    for pattern, group in ((LINK, 1), (ROLE, 1), (EMPHASIS, 2)):
        text = pattern.sub(lambda match, group=group: match[group], text)  # type: ignore[misc]
    text = MATHEMATICS.sub(lambda match: _mathematics(match[1]), text)
    text = "".join(one for one in " ".join(text.split()) if one.isprintable()).strip()
    if len(text) <= MOST_TITLE:
        return text
    return text[: MOST_TITLE - 1].rpartition(" ")[0].rstrip(" ,;:—–-") + "…"


def _mathematics(text: str) -> str:
    """Return LaTeX as plain text: letters and signs in place of commands, without braces."""
    return re.sub(r"[{}\\]", "", COMMAND.sub(lambda match: _sign(match[1]), text)).strip()


def _sign(command: str) -> str:
    if command in SIGNS:
        return SIGNS[command]
    size = "SMALL" if command.islower() else "CAPITAL"
    try:
        return unicodedata.lookup(f"GREEK {size} LETTER {command.upper()}")
    except KeyError:
        return ""
