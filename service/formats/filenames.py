"""Safe file names."""

import re
import unicodedata
from collections.abc import Iterable

MOST_BYTES = 80
DEVICES = {
    "con",
    "prn",
    "aux",
    "nul",
    *(f"{device}{n}" for device in ("com", "lpt") for n in "0123456789¹²³"),
}
_UNSAFE = re.compile(r"[^\w.@+-]+|_{2,}")


def safe_filename(text: str, default: str = "file") -> str:
    """Return the text as a safe file name, or ``default`` if nothing is left of it.

    The name has letters, digits and ``. _ - + @`` only, starts with a letter, digit or underscore, is not a
    Windows device, and has at most MOST_BYTES bytes.
    """
    name = _UNSAFE.sub("_", unicodedata.normalize("NFC", text)).lstrip(".-_@+ ").rstrip(".-_")
    name = _cut(name) or default
    return f"_{name}" if name.partition(".")[0].casefold() in DEVICES else name


class UniqueNames:
    """The file names used in one folder, starting with ``taken``."""

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self._taken = {_folded(name) for name in taken}

    def give(self, text: str, default: str = "file") -> str:
        """Return a safe file name that is not yet used in the folder, and reserve it.
        Letter case is ignored.
        """
        name = first = safe_filename(text, default)
        stem, dot, suffix = first.rpartition(".")
        count = 1
        while _folded(name) in self._taken:
            count += 1
            name = f"{stem}-{count}{dot}{suffix}" if stem else f"{first}-{count}"
        self._taken.add(_folded(name))
        return name


def _folded(name: str) -> str:
    return unicodedata.normalize("NFKC", unicodedata.normalize("NFKC", name).casefold())


def _cut(name: str) -> str:
    """Return at most MOST_BYTES of the name, keeping its suffix."""
    stem, dot, suffix = name.rpartition(".")
    if not stem or len(suffix) > 10:
        stem, dot, suffix = name, "", ""
    left = MOST_BYTES - len((dot + suffix).encode())
    return stem.encode()[:left].decode(errors="ignore").rstrip("._-") + dot + suffix
