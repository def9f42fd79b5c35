"""Zip archives that are sent while they are written."""

import io
import zipfile
from datetime import UTC, datetime

EARLIEST = (1980, 1, 1, 0, 0, 0)  # of the zip format


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
