"""Zip files and wheels whose bytes depend only on their content."""

import base64
import hashlib
import io
import zipfile
from collections.abc import Collection, Mapping
from types import MappingProxyType

EPOCH = (2000, 1, 1, 0, 0, 0)
WHEEL = b"Wheel-Version: 1.0\nGenerator: polhode\nRoot-Is-Purelib: true\nTag: py3-none-any\n"


def zipped(files: Mapping[str, bytes], runnable: Collection[str] = (), into: bytes = b"") -> bytes:
    """Return a zip of ``files`` in their order, readable by all, after those of the zip ``into``.

    Those in ``runnable`` are executable.
    """
    stream = io.BytesIO(into)
    with zipfile.ZipFile(stream, "a") as archive:
        for name, content in files.items():
            about = zipfile.ZipInfo(name, EPOCH)
            # 3: Unix
            about.create_system, about.external_attr = (
                3,
                (0o100755 if name in runnable else 0o100644) << 16,
            )
            archive.writestr(about, content, zipfile.ZIP_DEFLATED)
    return stream.getvalue()


class Wheel:
    """A pure wheel of ``files``, compressed once; ``info`` is the name of its .dist-info folder, to which its
    own files are added.
    """

    def __init__(self, info: str, metadata: str, files: Mapping[str, bytes]) -> None:
        files = {**files, f"{info}/METADATA": metadata.encode(), f"{info}/WHEEL": WHEEL}
        self._info, self._zip, self._record = info, zipped(files), _recorded(files)

    def content(self, more: Mapping[str, bytes] = MappingProxyType({})) -> bytes:
        """Return the bytes of the wheel with these further files."""
        record = "\n".join([*self._record, *_recorded(more), f"{self._info}/RECORD,,", ""])
        return zipped({**more, f"{self._info}/RECORD": record.encode()}, into=self._zip)


def _recorded(files: Mapping[str, bytes]) -> list[str]:
    """Return the lines of a wheel's RECORD."""
    return [
        f"{name},sha256={base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b'=').decode()},"
        f"{len(content)}"
        for name, content in files.items()
    ]
