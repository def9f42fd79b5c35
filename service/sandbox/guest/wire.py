"""Writing frames to the host; the format is described where it is read, in service/sandbox/wire.py."""

import json
import os
import struct
from typing import Any

import numpy as np


class Writer:
    """Frames on a file descriptor, whole or not at all as far as the guest is concerned."""

    def __init__(self, fd: int) -> None:
        self._fd = fd

    def event(self, name: str, **fields: Any) -> None:
        """A JSON event; texts that cannot be encoded are escaped."""
        self._frame(b"J", json.dumps({"event": name, **fields}, ensure_ascii=True).encode())

    def array(self, scene: str, name: str, value: Any) -> None:
        """An array as raw little-endian numbers behind its shape."""
        array = np.ascontiguousarray(value, dtype="u1" if value.dtype == np.uint8 else "<f8")
        header = json.dumps({"scene": scene, "name": name, "shape": list(value.shape)}).encode()
        self._frame(b"A", struct.pack("<H", len(header)) + header + array.tobytes())

    def _frame(self, kind: bytes, payload: bytes) -> None:
        data = memoryview(struct.pack("<cI", kind, len(payload)) + payload)
        while data:
            data = data[os.write(self._fd, data) :]
