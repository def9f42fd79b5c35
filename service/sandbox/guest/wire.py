"""The guest's side of the protocol of job.py and guest_frames.py: read the job, write frames."""

import base64
import fcntl
import functools
import json
import os
import select
import struct
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from threading import RLock
from typing import Any

import numpy as np

LENGTH = struct.Struct("<I")  # in front of the job
HEADER = struct.Struct("<H")  # in front of the header of named arrays
CHUNK = 1 << 16
FILES = {"setup": "Setup", "plays": "plays.py"}  # names of compiled texts in tracebacks
CLOCK_FACTOR = (
    4  # a budget's wall-clock limit, in units of its CPU limit: the machine may be loaded, the code may sleep
)
BYTES = "base64"  # key of an object that stands for bytes
NUMBERS = "float64"  # key of an object that stands for an array: its bytes, and its "shape"
APART = "{scene} {name} {row}"  # the name by which the process of a submission calls a function of a row
# What the process with the reference functions writes at each call of a function: its place in the list of
# them, and for how many calls it counts.
COUNT = struct.Struct("<IQ")
MALFORMED = 98  # exit code of the process with the reference functions when it reads an invalid frame
writing: list[Any] = []  # not empty while frames are written that belong together
Shapes = tuple[tuple[str, tuple[int, ...]], ...]


def pack(arrays: Mapping[str, Any]) -> bytes:
    """Return named arrays as bytes: header length, JSON header of shapes by name, then raw little-endian
    numbers.
    """
    values = {name: np.asarray(value, _dtype(value)) for name, value in arrays.items()}
    shapes = tuple([(name, value.shape) for name, value in values.items()])
    return b"".join([_header(shapes), *[value.tobytes() for value in values.values()]])


def _dtype(value: Any) -> str:
    return "u1" if getattr(value, "dtype", None) == np.uint8 else "<f8"


def _raw(array: np.ndarray, dtype: str) -> bytes:
    return np.ascontiguousarray(array, dtype=dtype).tobytes()


@functools.lru_cache(maxsize=64)
def _header(shapes: Shapes) -> bytes:
    head = json.dumps(dict(shapes)).encode()
    return HEADER.pack(len(head)) + head


def _decoded(value: dict[str, Any]) -> Any:
    """Return numbers that the host has sent as bytes as nested lists, bytes as such, any other object as it
    is.
    """
    if BYTES in value:
        return base64.b64decode(value[BYTES])
    if NUMBERS not in value:
        return value
    return np.frombuffer(value[NUMBERS], "<f8").reshape(value["shape"]).tolist()


class JobReader:
    """Reader of a job."""

    def __init__(self, fd: int) -> None:
        self._fd, self._poll, self._unread = fd, select.poll(), b""
        self._poll.register(fd, select.POLLIN)
        fcntl.fcntl(
            fd, fcntl.F_SETFL, os.O_NONBLOCK
        )  # a submission that reads here gets nothing and does not block

    def job(self) -> dict[str, Any]:
        """Return the job. Call it once, before the submission is loaded."""
        return json.loads(self._read(LENGTH.unpack(self._read(LENGTH.size))[0]), object_hook=_decoded)

    def _read(self, size: int) -> bytes:
        while len(self._unread) < size:
            self._poll.poll()
            more = os.read(self._fd, CHUNK)
            if not more:
                raise EOFError
            self._unread += more
        data, self._unread = self._unread[:size], self._unread[size:]
        return data


class Writer:
    """Writer of whole frames to a file descriptor."""

    def __init__(self, fd: int) -> None:
        self._fd, self._lock = fd, RLock()  # a submission may start threads

    def event(self, name: str, **fields: Any) -> None:
        """Write a JSON event. Characters that cannot be encoded are escaped."""
        self._frame(b"J", json.dumps({"event": name, **fields}, ensure_ascii=True).encode())

    def claim(self, header: dict[str, Any], arrays: Mapping[str, np.ndarray], most: int) -> None:
        """Write a claim of the notebook's own checks: its header with the shapes of its arrays and the names
        of complex ones, then raw little-endian numbers. Arrays of more than ``most`` numbers follow in blocks
        of their first axis.
        """
        types = {name: "<c16" if array.dtype.kind == "c" else "<f8" for name, array in arrays.items()}
        long = {name: array for name, array in arrays.items() if array.size > most}
        raw = [_raw(array, types[name]) for name, array in arrays.items() if name not in long]
        head = json.dumps(
            header
            | {"arrays": {name: list(array.shape) for name, array in arrays.items()}, "blocks": list(long)}
            | {"complex": [name for name in types if types[name] == "<c16"]}
        ).encode()
        with self._whole():
            self._frame(b"C", HEADER.pack(len(head)) + head + b"".join(raw))
            length = max(map(len, long.values()), default=0)
            rows = max(1, min((most * len(array) // array.size for array in long.values()), default=1))
            for first in range(0, length, rows):
                blocks = [_raw(array[first : first + rows], types[name]) for name, array in long.items()]
                self._frame(b"D", b"".join(blocks))

    @contextmanager
    def _whole(self) -> Iterator[None]:
        """Write what is written inside the ``with`` block without an interruption."""
        with self._lock:
            writing.append(self)
            try:
                yield
            finally:
                writing.pop()

    def arrays(self, arrays: Mapping[str, np.ndarray]) -> None:
        """Write the named arrays of a scene."""
        self._frame(b"A", pack(arrays))

    def _frame(self, kind: bytes, payload: bytes) -> None:
        data = memoryview(struct.pack("<cI", kind, len(payload)) + payload)
        with self._lock:
            while data:
                data = data[os.write(self._fd, data) :]
