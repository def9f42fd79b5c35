"""Safe file names, and zip archives that are sent while they are written."""

import io
import re
import unicodedata
import zipfile
from collections.abc import Iterable
from datetime import UTC, datetime

EARLIEST = (1980, 1, 1, 0, 0, 0)  # of the zip format
MOST_BYTES = 80
DEVICES = {
    "con",
    "prn",
    "aux",
    "nul",
    *(f"{device}{n}" for device in ("com", "lpt") for n in "0123456789¹²³"),
}
_UNSAFE = re.compile(r"[^\w.@+-]+|_{2,}")


class ZipStream:
    """A zip archive that is written and sent piece by piece; only its table of contents stays in memory.

    Call ``add`` for each file, ``take`` between files for the bytes so far, and ``end`` for the rest.
    """

    def __init__(self) -> None:
        self._sent = _Buffer()
        self._zip = zipfile.ZipFile(self._sent, "w", zipfile.ZIP_DEFLATED)

    def add(self, path: str, content: str | bytes, at: datetime) -> None:
        """Add a file with the modification time ``at``. The parts of ``path`` must be safe names."""
        when = at.astimezone(UTC).timetuple()[:6]
        about = zipfile.ZipInfo(path, max(EARLIEST, (when[0], when[1], when[2], when[3], when[4], when[5])))
        about.compress_type, about.external_attr = zipfile.ZIP_DEFLATED, 0o600 << 16
        self._zip.writestr(about, content)

    def take(self) -> bytes:
        """Return the bytes written since the last call."""
        content = self._sent.getvalue()
        self._sent.seek(0)
        self._sent.truncate()
        return content

    def end(self) -> bytes:
        """Finish the archive and return the remaining bytes."""
        self.close()
        return self.take()

    def close(self) -> None:
        """Finish the archive without returning its bytes."""
        self._zip.close()


class _Buffer(io.BytesIO):
    """A buffer without positions, so that the archive never goes back to what is sent."""

    def tell(self) -> int:
        raise io.UnsupportedOperation


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
