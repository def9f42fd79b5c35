"""Calls between the process of a submission and the one that holds reference functions, over a pair of
sockets.

A frame is its length, the length of its JSON header, the header, and the bytes of its arrays. Values that
cross: None, numbers, texts, numpy arrays and numbers of real or complex type, lists, tuples, dicts, scipy's
results, and functions, which the other process can call during the call that passes them. Of a random
generator its methods DRAWS cross. Nothing is pickled: the reader of a frame runs only functions that it has
exported or passed.
"""

import builtins
import json
import os
import re
import struct
import sys
from collections.abc import Callable, Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np

from .wire import MALFORMED

LOADED = "?"  # the exported function that returns why the others could not be loaded, "" if they were
HEAD = struct.Struct("<II")
MOST_BYTES = 16 << 20  # of a frame
MOST_NESTED = 16  # lists and dicts in each other
MOST_OPEN = 20  # calls that wait for an answer
MOST_TEXT = 1000  # characters of an exception's message
DTYPE = re.compile(r"[<>|][biufc]\d{1,2}")
DRAWS = (
    "binomial",
    "choice",
    "exponential",
    "integers",
    "normal",
    "permutation",
    "poisson",
    "random",
    "standard_normal",
    "uniform",
)
INVALID = (ValueError, TypeError, LookupError, AttributeError, ArithmeticError, RecursionError)
TYPES = {
    "call": ((str, tuple, dict), (int, tuple, dict)),
    "raise": ((str, str, int, int),),
}  # of a frame's values, by its kind
NOTHING: Mapping[str | int, Callable[..., Any]] = {}
TOO_LARGE = "!"  # the function that is called in place of one whose arguments do not fit into memory
CALL = b'["call"'  # begins the header of a call
NO_ROOM = "the values of one call take more memory than the process of the reference functions has"
STOPPED = (
    "the process of the reference functions stopped: they were called with values that need too much time or"
    " memory"
)


class Draws(SimpleNamespace):
    """The methods DRAWS of a random generator of the other process."""


class Channel:
    """One end of a pair of sockets. ``exported`` are the functions that the other end may call by name.

    With ``exits`` the process exits when the other end is closed, and with the code MALFORMED when a frame is
    invalid. ``lost`` is True once the other process has ended or a call was broken off: nothing can be called
    any more.
    """

    def __init__(
        self, fd: int, exported: Mapping[str | int, Callable[..., Any]] = NOTHING, *, exits: bool = False
    ) -> None:
        self._fd, self._exits, self.lost = fd, exits, False
        self._incoming = open(fd, "rb", closefd=False)  # noqa: SIM115 -- lives as long as the channel
        self._functions = dict(exported)
        self._passed = self._received = self._open = self._raised = 0
        self._exception: BaseException | None = (
            None  # the last one that a function of this end raised, number ``_raised``
        )

    def proxy(self, target: str | int, name: str) -> Callable[..., Any]:
        """Return a function that calls the other end's function ``target``."""

        def proxy(*values: Any, **named: Any) -> Any:
            return self.call(target, *values, **named)

        proxy.__name__ = proxy.__qualname__ = name
        return proxy

    def call(self, target: str | int, /, *values: Any, **named: Any) -> Any:
        """Call a function of the other end, and answer its calls meanwhile.
        Raises what that function raises.
        """
        if self.lost:
            raise RuntimeError(STOPPED)
        if self._open >= MOST_OPEN:
            raise RecursionError(f"more than {MOST_OPEN} calls wait for each other")
        passed, received = self._passed, self._received
        frame, finished = self._pack("call", target, values, named), False
        self._open += 1
        try:
            self._send(frame)
            while (message := self._receive())[0] == "call":
                self._answer(*message[1:])
            finished = True
        finally:
            self._open -= 1
            self.lost = self.lost or not finished
        if self._received == received:  # else a received function may still call those that were passed
            for number in range(passed, self._passed):
                self._functions.pop(number, None)
        if message[0] == "raise":
            raise self._error(*message[1:])
        return message[1]

    def serve(self) -> None:
        """Answer calls until the other end is closed, which ends the process."""
        while (message := self._receive())[0] == "call":
            self._answer(*message[1:])
        os._exit(MALFORMED)

    def _answer(self, target: str | int, values: tuple[Any, ...], named: dict[str, Any]) -> None:
        try:
            if target == TOO_LARGE:
                raise ValueError(NO_ROOM)
            if (function := self._functions.get(target)) is None:
                raise RuntimeError("a function was called after the call that passed it")
            frame = self._pack("return", function(*values, **named))
        except BaseException as error:
            if not (self._exits or isinstance(error, Exception)):
                raise
            if not (theirs := getattr(error, "number_at_other_end", 0)):
                self._raised, self._exception = self._raised + 1, error
            frame = self._pack("raise", type(error).__name__, _message(error), self._raised, theirs)
        self._send(frame)

    def _error(self, name: str, text: str, theirs: int, own: int) -> BaseException:
        """Return the exception to raise: the one of this end that the other end passes on, else one of the
        same built-in class.
        """
        if own == self._raised and self._exception is not None:
            return self._exception
        kind = getattr(builtins, name, None)
        try:
            error = (
                kind(text)
                if isinstance(kind, type) and issubclass(kind, Exception)
                else RuntimeError(f"{name}: {text}")
            )
        except TypeError:  # UnicodeDecodeError, for example, needs more arguments
            error = RuntimeError(f"{name}: {text}")
        error.number_at_other_end = theirs  # type: ignore[attr-defined]
        return error

    def _send(self, frame: bytes) -> None:
        left = memoryview(frame)
        while left:
            try:
                left = left[os.write(self._fd, left) :]
            except OSError:
                self._end(0)

    def _receive(self) -> list[Any]:
        """Return the kind of the next frame and its values."""
        length, header = HEAD.unpack(self._read(HEAD.size))
        if not header <= length <= MOST_BYTES:
            self._end(MALFORMED)
        data = self._read(length)
        try:
            return self._unpack(data[:header], data[header:])
        except MemoryError:  # short lists, for example, take twenty times the bytes of their text
            is_call = data.startswith(CALL)
            return ["call", TOO_LARGE, (), {}] if is_call else ["raise", ValueError.__name__, NO_ROOM, 0, 0]
        except INVALID:
            self._end(MALFORMED)
            raise

    def _read(self, size: int) -> bytes:
        try:
            data = self._incoming.read(size)
        except OSError:
            data = b""
        if len(data) < size:
            self._end(0)
        return data

    def _end(self, code: int) -> None:
        if self._exits:
            os._exit(code)
        raise RuntimeError(STOPPED)

    def _pack(self, kind: str, *values: Any) -> bytes:
        """Return a frame. Raises TypeError for a value that cannot cross, and ValueError for values that are
        too large.
        """
        arrays: list[bytes] = []
        header = json.dumps([kind, *[self._node(value, arrays, 0) for value in values]]).encode()
        length = len(header) + sum(map(len, arrays))
        if length > MOST_BYTES:
            raise ValueError(f"the values of one call are larger than {MOST_BYTES >> 20} MiB")
        return b"".join([HEAD.pack(length, len(header)), header, *arrays])

    def _node(self, value: Any, arrays: list[bytes], depth: int) -> Any:
        """Return a value as JSON and append the bytes of its arrays. Each list begins with the kind of what
        it stands for.
        """
        if value is None or type(value) in (bool, int, float, str):
            return value
        if depth > MOST_NESTED:
            raise TypeError(f"a value is nested more than {MOST_NESTED} deep")
        node: Any
        if isinstance(value, np.ndarray | np.generic) and value.dtype.kind in "biufc":
            arrays.append(value.tobytes())
            node = ["array" if isinstance(value, np.ndarray) else "number", value.dtype.str, *value.shape]
        elif isinstance(value, complex):
            node = ["complex", value.real, value.imag]
        elif isinstance(value, list | tuple):
            items = [self._node(item, arrays, depth + 1) for item in value]
            node = ["list" if isinstance(value, list) else "tuple", *items]
        elif isinstance(value, dict):
            kind = "result" if _is_result(value) else "dict"
            node = [kind, *[[self._node(item, arrays, depth + 1) for item in pair] for pair in value.items()]]
        elif isinstance(value, str):
            node = str(value)
        elif isinstance(value, np.random.Generator | Draws):
            node = ["generator", *[self._node(getattr(value, name), arrays, depth + 1) for name in DRAWS]]
        elif callable(value):
            self._functions[self._passed] = value
            node = ["function", self._passed, str(getattr(value, "__name__", "function"))]
            self._passed += 1
        else:
            raise TypeError(
                f"your functions and the reference cannot exchange a value of type {type(value).__name__}"
            )
        return node

    def _unpack(self, header: bytes, raw: bytes) -> list[Any]:
        """Return the kind of a frame and its values. Raises one of INVALID."""
        at = 0

        def value(node: Any) -> Any:
            nonlocal at
            if not isinstance(node, list):
                return node
            found: Any
            match node:
                case ["array" | "number", str(dtype), *shape] if DTYPE.fullmatch(dtype):
                    array: Any = np.ndarray(shape, dtype, raw, at).copy()  # raises TypeError beyond the end
                    at += array.nbytes
                    found = array if node[0] == "array" else array[()]
                case ["complex", real, imaginary]:
                    found = complex(real, imaginary)
                case ["list" | "tuple", *items]:
                    values = [value(item) for item in items]
                    found = values if node[0] == "list" else tuple(values)
                case ["dict" | "result", *pairs]:
                    found = {value(key): value(item) for key, item in pairs}
                    if node[0] == "result":
                        from scipy.optimize import OptimizeResult

                        found = OptimizeResult(**found)
                case ["generator", *draws]:
                    found = Draws(**{draw.__name__: draw for draw in map(value, draws)})
                case ["function", int(number), str(name)]:
                    self._received += 1
                    found = self.proxy(number, name)
                case _:
                    raise ValueError("not a value")
            return found

        kind, *nodes = json.loads(header)
        values = [value(node) for node in nodes]
        valid = len(values) == 1 if kind == "return" else tuple(map(type, values)) in TYPES[kind]
        if not valid or at != len(raw):
            raise ValueError("not a message")
        return [kind, *values]


def _is_result(value: dict[Any, Any]) -> bool:
    optimize = sys.modules.get("scipy.optimize")
    return type(value) is not dict and optimize is not None and isinstance(value, optimize.OptimizeResult)


def _message(error: BaseException) -> str:
    try:
        return str(error)[:MOST_TEXT]
    except BaseException:  # its own __str__ fails
        return ""
