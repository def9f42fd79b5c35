"""Zip files and wheels whose bytes depend only on their content."""

import base64
import hashlib
import io
import zipfile
from collections.abc import Collection, Mapping

EPOCH = (2000, 1, 1, 0, 0, 0)


def zipped(files: Mapping[str, bytes], runnable: Collection[str] = ()) -> bytes:
    """Return a zip of ``files`` in their order, readable by all; those in ``runnable`` are executable."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        for name, content in files.items():
            about = zipfile.ZipInfo(name, EPOCH)
            about.create_system, about.external_attr = 3, (0o100755 if name in runnable else 0o100644) << 16  # 3: Unix
            archive.writestr(about, content, zipfile.ZIP_DEFLATED)
    return stream.getvalue()


def wheel(info: str, files: Mapping[str, bytes]) -> bytes:
    """Return a wheel of ``files``; ``info`` is the name of its .dist-info folder, whose RECORD is added."""
    return zipped({**files, f"{info}/RECORD": _record(info, files)})


def _record(info: str, files: Mapping[str, bytes]) -> bytes:
    lines = []
    for name, content in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        lines.append(f"{name},sha256={digest},{len(content)}")
    return "\n".join([*lines, f"{info}/RECORD,,", ""]).encode()
