"""Zip files and wheels whose bytes depend only on their content."""

import base64
import hashlib
import io
import zipfile
from collections.abc import Collection, Mapping

EPOCH = (2000, 1, 1, 0, 0, 0)
WHEEL = b"Wheel-Version: 1.0\nGenerator: polhode\nRoot-Is-Purelib: true\nTag: py3-none-any\n"


def zipped(files: Mapping[str, bytes], runnable: Collection[str] = ()) -> bytes:
    """Return a zip of ``files`` in their order, readable by all; those in ``runnable`` are executable."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        for name, content in files.items():
            about = zipfile.ZipInfo(name, EPOCH)
            # 3: Unix
            about.create_system, about.external_attr = (
                3,
                (0o100755 if name in runnable else 0o100644) << 16,
            )
            archive.writestr(about, content, zipfile.ZIP_DEFLATED)
    return stream.getvalue()


def wheel(info: str, metadata: str, files: Mapping[str, bytes]) -> bytes:
    """Return a pure wheel of ``files``; ``info`` is the name of its .dist-info folder, to which its own files
    are added.
    """
    files = {**files, f"{info}/METADATA": metadata.encode(), f"{info}/WHEEL": WHEEL}
    record = []
    for name, content in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        record.append(f"{name},sha256={digest},{len(content)}")
    return zipped({**files, f"{info}/RECORD": "\n".join([*record, f"{info}/RECORD,,", ""]).encode()})
