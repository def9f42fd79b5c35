"""The zip that is sent while it is written is whole, and keeps nothing of what was sent."""

import io
import os
import tracemalloc
import zipfile
from datetime import UTC, datetime

from service.formats.zip_stream import ZipStream

AT = datetime(2026, 2, 28, 23, 59, 58, tzinfo=UTC)


def test_it_is_a_whole_zip_with_names_and_times():
    archive, parts = ZipStream(), []
    for path, content in {"a/é.txt": "x\n" * 5000, "a/b.bin": os.urandom(3000), "a/empty": ""}.items():
        archive.add(path, content, AT)
        parts.append(archive.take())
    assert all(parts)
    with zipfile.ZipFile(io.BytesIO(b"".join([*parts, archive.end()]))) as read:
        assert read.testzip() is None
        assert read.namelist() == ["a/é.txt", "a/b.bin", "a/empty"]
        assert read.read("a/é.txt") == b"x\n" * 5000
        assert read.infolist()[0].date_time == (2026, 2, 28, 23, 59, 58)


def test_it_does_not_hold_what_was_taken():
    archive, content = ZipStream(), os.urandom(1_000_000)
    tracemalloc.start()
    try:
        sent = 0
        for number in range(30):
            archive.add(f"{number}", content, AT)
            sent += len(archive.take())
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert sent > 30_000_000 and most < 6_000_000
