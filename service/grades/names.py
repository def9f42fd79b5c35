"""Names of files that are safe everywhere, made of what people wrote; no two of a folder fall together."""

import re
import unicodedata
from collections.abc import Iterable

MOST_BYTES = 80
DEVICES = {"con", "prn", "aux", "nul", *(f"{device}{n}" for device in ("com", "lpt") for n in "0123456789¹²³")}
_UNSAFE = re.compile(r"[^\w.@+-]+|_{2,}")


def safe(text: str, otherwise: str = "file") -> str:
    """One part of a path: letters, digits, ``. _ - + @``; no dot or dash in front, no device of Windows, not too long."""
    name = _UNSAFE.sub("_", unicodedata.normalize("NFC", text)).lstrip(".-_@+ ").rstrip(".-_")
    name = _cut(name) or otherwise
    return f"_{name}" if name.partition(".")[0].casefold() in DEVICES else name


class Names:
    """The names given out in one folder, those ``taken`` among them."""

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self._taken = {_folded(name) for name in taken}

    def give(self, text: str, otherwise: str = "file") -> str:
        """A safe name that is not given yet, also where a file system takes large for small letters."""
        name = first = safe(text, otherwise)
        stem, dot, ending = first.rpartition(".")
        count = 1
        while _folded(name) in self._taken:
            count += 1
            name = f"{stem}-{count}{dot}{ending}" if stem else f"{first}-{count}"
        self._taken.add(_folded(name))
        return name


def _folded(name: str) -> str:
    return unicodedata.normalize("NFKC", unicodedata.normalize("NFKC", name).casefold())


def _cut(name: str) -> str:
    """At most MOST_BYTES of it, with its ending."""
    stem, dot, ending = name.rpartition(".")
    if not stem or len(ending) > 10:
        stem, dot, ending = name, "", ""
    room = MOST_BYTES - len((dot + ending).encode())
    return stem.encode()[:room].decode(errors="ignore").rstrip("._-") + dot + ending
