"""A zip that is sent while it is written: of what was sent nothing is kept but its table of contents."""

import io
import zipfile
from datetime import UTC, datetime

EARLIEST = (1980, 1, 1, 0, 0, 0)  # what a zip can tell


class Archive:
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
