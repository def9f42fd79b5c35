"""Read the bytes of a roster as text, whatever tool wrote them."""

import re
from dataclasses import dataclass

from service.store.people.roster.problems import BadRoster

# The names that pages and messages show, and Python's names. Those after UTF-16 have a character for (nearly)
# every byte, so which one a file has is a guess.
ENCODINGS = {
    "UTF-8": "utf-8-sig",
    "UTF-16": "utf-16",
    "Windows-1252": "cp1252",
    "Mac Roman": "mac_roman",
    "DOS 850": "cp850",
    "Windows-1250": "cp1250",
}
GUESSED = ("Windows-1252", "Mac Roman", "DOS 850")
EXPECTED = frozenset("äöüßéèêëáàâãåóòôõøíìîïúùûñçæÄÖÜÉÈÊËÁÀÂÃÅÓÒÔÕØÍÌÎÏÚÙÛÑÇÆ")
SPREADSHEETS = (b"PK\x03\x04", b"\xd0\xcf\x11\xe0")  # the first bytes of XLSX and ODS, and of XLS
# Replacement characters, UTF-8 that was read as Windows-1252, and numbers that a spreadsheet rounded.
DAMAGED = re.compile(
    "\N{REPLACEMENT CHARACTER}|[ÃÅÄ][\u0080-\u00bf€‚ƒ„…†‡ˆ‰Š‹ŒŽ‘’“”•–—˜™š›œžŸ]|\\d[.,]\\d+E\\+\\d+"
)


@dataclass(frozen=True)
class Text:
    """The text of a file, and its encoding, a key of ENCODINGS. If ``guessed``, it may be another one."""

    text: str
    encoding: str
    guessed: bool = False


def decode(content: bytes, file: str, encoding: str | None = None) -> Text:
    """Return the text of a file in an encoding, or in the one that fits best.

    Raises BadRoster if the file is not text, or not in that encoding.
    """
    if content.startswith(SPREADSHEETS):
        raise BadRoster(f"{file} is a spreadsheet, not text: save it as CSV UTF-8")
    if encoding is not None and encoding not in ENCODINGS:
        raise BadRoster(f"the encoding must be one of {', '.join(ENCODINGS)}, not {encoding[:40]}")
    if encoding is not None:
        try:
            return Text(content.decode(ENCODINGS[encoding]), encoding)
        except UnicodeDecodeError as error:
            raise BadRoster(f"{file} is not text in {encoding} ({error}): choose another encoding") from None
    return _guess(content, file)


def _guess(content: bytes, file: str) -> Text:
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        return _utf_16(content, "utf-16", file)
    if b"\x00" in content:
        little_endian = content[1::2].count(0) > content[::2].count(0)
        return _utf_16(content, "utf-16-le" if little_endian else "utf-16-be", file)
    try:
        return Text(content.decode("utf-8-sig"), "UTF-8")
    except UnicodeDecodeError:
        texts = {name: content.decode(ENCODINGS[name], errors="replace") for name in GUESSED}
        best = min(GUESSED, key=lambda name: _unexpected(texts[name]))
        return Text(texts[best], best, guessed=True)


def _utf_16(content: bytes, codec: str, file: str) -> Text:
    try:
        return Text(content.decode(codec).removeprefix("\ufeff"), "UTF-16")
    except UnicodeDecodeError:
        raise BadRoster(f"{file} is not text: save the roster as CSV UTF-8") from None


def _unexpected(text: str) -> int:
    """Return how many characters are neither ASCII nor letters of Western Europe."""
    return sum(not c.isascii() and c not in EXPECTED for c in text)
