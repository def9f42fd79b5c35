"""Calls between two processes: what crosses, what is raised, and what a process with reference functions does
with other bytes.
"""

import json
import math
import os
import socket
import struct
from contextlib import contextmanager

import numpy as np
import pytest
import scipy.integrate

from service.sandbox.guest.cross_process_calls import HEAD, MOST_BYTES, MOST_NESTED, MOST_OPEN, Channel
from service.sandbox.guest.wire import MALFORMED


def same(x):
    return x


def named(a, *, b):
    return [a, b]


def apply(f, *values):
    return f(*values)


def apply_caught(f):
    try:
        return f()
    except ValueError as error:
        return f"caught {error}"


def fails():
    raise KeyError("α")


def ends():
    raise SystemExit(3)


def adder(n):
    return lambda x: x + n


def walk(rng, n):
    return np.cumsum(rng.normal(size=n)) + rng.integers(0, 9, endpoint=True)


def solved(t):
    return scipy.integrate.solve_ivp(lambda t, y: -y, (0, t), [1.0])


def composed(f, g):
    return lambda x: f(g(x))


FUNCTIONS = {
    f.__name__: f for f in (same, named, apply, apply_caught, fails, ends, adder, composed, walk, solved)
}


@contextmanager
def other_process():
    """A process that holds FUNCTIONS: this end of its socket, and a function that closes it and returns the
    exit code.
    """
    here, there = socket.socketpair()
    child = os.fork()
    if child == 0:
        here.close()
        Channel(there.detach(), FUNCTIONS, exits=True).serve()
    there.close()
    codes = []

    def exit_code():
        if not codes:
            here.close()
            codes.append(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
        return codes[0]

    try:
        yield here, exit_code
    finally:
        exit_code()


@pytest.fixture
def channel():
    with other_process() as (here, exit_code):
        yield Channel(here.fileno())
        assert exit_code() == 0


VALUES = [
    None, True, 3, -(10**30), 0.1, -0.0, math.inf, "α\ud800", 1 + 2j, [], (), {}, [1, (2.0, [None])], {"a": 1,
        2: {(1, 2): [3]}},
    np.float64(0.1), np.float32(0.1), np.int8(-3), np.bool_(True), np.complex128(1j), np.array(2.5),
        np.zeros((0, 3)),
    np.arange(6, dtype="i2").reshape(2, 3), np.arange(4.0)[::-2], np.array([[1 + 1j, 2]]), np.array([1.0],
        ">f8"),
]  # fmt: skip


@pytest.mark.parametrize("value", VALUES, ids=repr)
def test_values_cross_unchanged(channel, value):
    got = channel.call("same", value)
    assert type(got) is type(value)
    if isinstance(value, np.ndarray):
        assert got.dtype == value.dtype and got.shape == value.shape and got.tobytes() == value.tobytes()
    else:
        assert repr(got) == repr(value)


def test_a_proxy_is_called_as_the_function_is(channel):
    proxy = channel.proxy("named", "named")
    assert proxy.__name__ == "named" and proxy(1, b=2.0) == [1, 2.0]
    with pytest.raises(TypeError, match="required keyword-only argument"):
        proxy(1)


def test_functions_are_called_back_during_the_call(channel):
    inner = channel.proxy("apply", "apply")
    assert channel.call("apply", lambda x: inner(lambda y: y * 2, x) + 1, 5) == 11
    kept = []
    channel.call("apply", kept.append, lambda: 7)
    with pytest.raises(RuntimeError, match="after the call that passed it"):
        kept[0]()


def test_a_random_generator_stays_that_of_the_caller(channel):
    here, there = np.random.default_rng(1), np.random.default_rng(1)
    for _ in range(2):
        assert np.array_equal(channel.call("walk", there, 5), walk(here, 5))
    with pytest.raises(AttributeError):
        channel.call("apply", lambda rng: rng.bit_generator, there)


def test_a_result_of_scipy_keeps_its_attributes(channel):
    got = channel.call("solved", 2.0)
    assert got.success and got.y.tobytes() == solved(2.0).y.tobytes() and got["t"][-1] == 2.0


def test_a_returned_function_can_be_called_later(channel):
    assert channel.call("adder", 3)(4) == 7
    assert channel.call("composed", lambda x: 10 * x, channel.call("adder", 1))(2) == 30


def test_many_calls_with_new_functions_keep_none_of_them(channel):
    for k in range(200):
        assert channel.call("apply", lambda x, k=k: x + k, 1) == k + 1
    assert not channel._functions


def test_exceptions_are_raised_on_the_other_side(channel):
    with pytest.raises(KeyError, match="α"):
        channel.call("fails")
    with pytest.raises(RuntimeError, match="SystemExit: 3"):
        channel.call("ends")
    assert channel.call("apply_caught", lambda: int("x")).startswith("caught invalid literal")
    with pytest.raises(TypeError, match="cannot exchange a value of type object"):
        channel.call("same", object())
    with pytest.raises(TypeError, match=f"more than {MOST_NESTED} deep"):
        channel.call("same", (endless := [], endless.append(endless))[0])
    with pytest.raises(ValueError, match="larger than 16 MiB"):
        channel.call("same", np.zeros(MOST_BYTES // 8))
    assert channel.call("same", 1) == 1  # all of this leaves the channel as it was


class OwnError(Exception):
    def __str__(self):
        raise ZeroDivisionError


def test_an_exception_of_a_passed_function_comes_back_itself(channel):
    own = OwnError()

    def raising():
        raise own

    with pytest.raises(OwnError) as raised:
        channel.call("apply", raising)
    assert raised.value is own
    with pytest.raises(TypeError, match="cannot exchange"):
        channel.call("apply", object)


def test_calls_that_wait_for_each_other_are_limited(channel):
    def deeper():
        return channel.call("apply", deeper)

    with pytest.raises(RecursionError, match=f"more than {MOST_OPEN} calls"):
        deeper()
    assert channel.call("same", 1) == 1


def test_a_call_that_is_broken_off_ends_the_channel(channel):
    def stops():
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        channel.call("apply", stops)
    assert channel.lost
    with pytest.raises(RuntimeError, match="stopped"):
        channel.call("same", 1)


def frame(header, raw=b""):
    text = header if isinstance(header, bytes) else json.dumps(header).encode()
    return HEAD.pack(len(text) + len(raw), len(text)) + text + raw


def call(value):
    return ["call", "same", ["tuple", value], ["dict"]]


@pytest.mark.parametrize(
    "data",
    [
        HEAD.pack(MOST_BYTES + 1, 0),
        struct.pack("<II", 0xFFFFFFFF, 0xFFFFFFFF),
        HEAD.pack(3, 4) + b"[[[[",
        frame(b"\x80\x04\x95"),  # a pickle
        frame(b"[" * 200_000),
        frame(call(json.loads("[" * 900 + "]" * 900))),
        frame({}),
        frame([]),
        frame(["stop"]),
        frame(["return", 1]),
        frame(["call", "same", ["list"], ["dict"]]),
        frame(["call", ["list"], ["tuple"], ["dict"]]),
        frame(call(["object", 1])),
        frame(call(["array", "|O", 1]), bytes(8)),
        frame(call(["array", "<f8", 2]), bytes(8)),
        frame(call(["array", "<f8", 1]), bytes(9)),
        frame(call(["array", "<f8", -1, -1]), bytes(8)),
        frame(call(["array", "<f8", 1 << 62, 4]), bytes(8)),
        frame(call(["array", "<f8", *[1] * 100]), bytes(8)),
        frame(call(["dict", [["list"], 1]])),
        frame(call(["function", "exec", "f"])),
        frame(["raise", "KeyError", "x", 1]),
    ],
    ids=lambda data: repr(data[:40]),
)
def test_an_invalid_frame_ends_the_process(data):
    with other_process() as (here, exit_code):
        here.sendall(data)
        assert exit_code() == MALFORMED


@pytest.mark.parametrize("target", ["exec", "__import__", "os", 0, 1, -1])
def test_only_exported_functions_are_called(channel, target):
    with pytest.raises(RuntimeError, match="a function was called after"):
        channel.call(target, "1")


def test_half_a_frame_ends_the_process_without_an_error():
    with other_process() as (here, exit_code):
        here.sendall(frame(call(1))[:-1])
        assert exit_code() == 0
