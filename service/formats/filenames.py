"""A zip that is sent while it is written: of what was sent nothing is kept but its table of contents."""

import io
import re
import unicodedata
import zipfile
from collections.abc import Iterable
from datetime import UTC, datetime

EARLIEST = (1980, 1, 1, 0, 0, 0)  # what a zip can tell


class ZipStream:
    """Add files, and between them ``take`` the bytes that can go; ``end`` gives the last."""

    def __init__(self) -> None:
        self._sent = _Sent()
        self._zip = zipfile.ZipFile(self._sent, "w", zipfile.ZIP_DEFLATED)

    def add(self, path: str, content: str | bytes, at: datetime) -> None:
        """Add a file under a path of safe names, last changed at that time."""
        when = at.astimezone(UTC).timetuple()[:6]
        about = zipfile.ZipInfo(path, max(EARLIEST, (when[0], when[1], when[2], when[3], when[4], when[5])))
        about.compress_type, about.external_attr = zipfile.ZIP_DEFLATED, 0o600 << 16
        self._zip.writestr(about, content)

    def take(self) -> bytes:
        """What was written since the last time."""
        return self._sent.take()

    def end(self) -> bytes:
        """The same, with the table of contents; nothing can be added any more."""
        self.close()
        return self.take()

    def close(self) -> None:
        """Add no more, also where nobody takes the rest."""
        self._zip.close()


class _Sent(io.RawIOBase):
    """A stream that cannot go back."""

    def __init__(self) -> None:
        self._parts: list[bytes] = []

    def writable(self) -> bool:
        return True

    def write(self, data: "bytes | bytearray | memoryview") -> int:  # type: ignore[override]
        self._parts.append(bytes(data))
        return len(data)

    def take(self) -> bytes:
        taken, self._parts = b"".join(self._parts), []
        return taken


MOST_BYTES = 80
DEVICES = {"con", "prn", "aux", "nul", *(f"{device}{n}" for device in ("com", "lpt") for n in "0123456789¹²³")}
_UNSAFE = re.compile(r"[^\w.@+-]+|_{2,}")


def safe_filename(text: str, otherwise: str = "file") -> str:
    """One part of a path: letters, digits, ``. _ - + @``; no dot or dash in front, no device of Windows, not too long."""
    name = _UNSAFE.sub("_", unicodedata.normalize("NFC", text)).lstrip(".-_@+ ").rstrip(".-_")
    name = _cut(name) or otherwise
    return f"_{name}" if name.partition(".")[0].casefold() in DEVICES else name


class UniqueNames:
    """The names given out in one folder, those ``taken`` among them."""

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self._taken = {_folded(name) for name in taken}

    def give(self, text: str, otherwise: str = "file") -> str:
        """A safe name that is not given yet, also where a file system takes large for small letters."""
        name = first = safe_filename(text, otherwise)
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
