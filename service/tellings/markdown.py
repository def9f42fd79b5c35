"""Text of others' in GitHub's Markdown: as code, which nobody is mentioned by and nothing breaks out of."""

import re

from service.tellings.detail import one_line, shown

_PLAIN = re.compile(r"[^\w ]|_", re.ASCII)


def code(told: str) -> str:
    """In a line, also in a cell of a table: every sign an entity, which Markdown reads as a sign and never as its own."""
    return f"<code>{escaped(told)}</code>"


def escaped(told: str) -> str:
    """The same without being code: for what is ours."""
    return _PLAIN.sub(lambda sign: sign[0] if ord(sign[0]) > 127 else f"&#{ord(sign[0])};", one_line(told))


def block(told: str) -> str:
    """Lines as they are, behind a fence longer than any in them."""
    plain = shown(told).rstrip("\n")
    fence = "`" * max(3, 1 + max(map(len, re.findall("`+", plain)), default=0))
    return f"{fence}text\n{plain}\n{fence}"
