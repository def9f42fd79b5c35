"""The order in which people are listed: by surname and first name, without case and accents."""

import unicodedata

from service.formats.gradebooks import split_name

# Letters that Unicode does not decompose into a base letter and an accent. Casefolding has replaced ß by ss.
UNDECOMPOSED = str.maketrans(
    {"æ": "ae", "œ": "oe", "ø": "o", "ł": "l", "đ": "d", "ð": "d", "þ": "th", "ħ": "h", "ı": "i"}
)
# Between surname and first name: it sorts before every character of a name, so "Lee" comes before "Leeb".
BETWEEN = "\t"


def fold(text: str) -> str:
    """Return the text without case and accents, to search and to sort by."""
    decomposed = unicodedata.normalize("NFKD", text.casefold())
    return "".join(c for c in decomposed if not unicodedata.combining(c)).translate(UNDECOMPOSED)


def sort_key(name: str, full_name: str | None = None, surname: str | None = None) -> str:
    """Return what lists of people are ordered by: the folded surname and first name.

    The surname is ``surname`` if known, and else the part of the full name before a comma, or its last word.
    Without a full name the key is the folded login name.
    """
    if not full_name:
        return fold(name)
    last, first = split_name(full_name)
    if surname:
        last, first = surname, full_name.removesuffix(surname).strip()
    return f"{fold(last)}{BETWEEN}{fold(first)}"
