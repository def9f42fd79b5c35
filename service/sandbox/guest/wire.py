"""The guest's side of the protocol: read the job and its questions, write frames. See job.py and wire.py of the host."""

import fcntl
import json
import math
import os
import select
import struct
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

LENGTH = struct.Struct("<I")  # in front of the job
QUESTION = struct.Struct("<7d")  # t, w, I of one call of the student's function; t is NaN after the last question
ANSWER = struct.Struct("<3d")
Asked = tuple[float, np.ndarray, np.ndarray]


class Questions:
    """Reader of the job and of the host's questions after it: t, w (3,), I (3,)."""

    def __init__(self, fd: int) -> None:
        self._fd, self._poll = fd, select.poll()
        self._poll.register(fd, select.POLLIN)
        fcntl.fcntl(fd, fcntl.F_SETFL, os.O_NONBLOCK)  # a submission that reads here gets nothing and does not block

    def job(self) -> dict[str, Any]:
        """Return the job. Call it once, before the submission is loaded."""
        return json.loads(self._read(LENGTH.unpack(self._read(LENGTH.size))[0]))

    def __iter__(self) -> Iterator[Asked]:
        """Yield the questions of one scene until its last."""
        while True:
            t, *rest = QUESTION.unpack(self._read(QUESTION.size))
            if math.isnan(t):
                return
            yield t, np.array(rest[:3]), np.array(rest[3:])

    def _read(self, size: int) -> bytes:
        data = b""
        while len(data) < size:
            self._poll.poll()
            more = os.read(self._fd, size - len(data))
            if not more:
                raise EOFError
            data += more
        return data


class Writer:
    """Writer of whole frames to a file descriptor."""

    def __init__(self, fd: int) -> None:
        self._fd = fd

    def event(self, name: str, **fields: Any) -> None:
        """Write a JSON event. Characters that cannot be encoded are escaped."""
        self._frame(b"J", json.dumps({"event": name, **fields}, ensure_ascii=True).encode())

    def array(self, scene: str, name: str, value: Any) -> None:
        """Write an array: its shape, then raw little-endian numbers."""
        array = np.ascontiguousarray(value, dtype="u1" if value.dtype == np.uint8 else "<f8")
        self._headed(b"A", {"scene": scene, "name": name, "shape": list(value.shape)}, array.tobytes())

    def claim(self, header: dict[str, Any], arrays: Mapping[str, np.ndarray]) -> None:
        """Write a claim of the notebook's own checks: its header with the shapes of its arrays, then raw little-endian numbers."""
        raw = b"".join(np.ascontiguousarray(array, dtype="<f8").tobytes() for array in arrays.values())
        self._headed(b"C", header | {"arrays": {name: list(array.shape) for name, array in arrays.items()}}, raw)

    def answer(self, value: np.ndarray) -> None:
        """Write the answer (3,) to a question."""
        self._frame(b"R", ANSWER.pack(*value))

    def _headed(self, kind: bytes, header: dict[str, Any], raw: bytes) -> None:
        head = json.dumps(header).encode()
        self._frame(kind, struct.pack("<H", len(head)) + head + raw)

    def _frame(self, kind: bytes, payload: bytes) -> None:
        data = memoryview(struct.pack("<cI", kind, len(payload)) + payload)
        while data:
            data = data[os.write(self._fd, data) :]
