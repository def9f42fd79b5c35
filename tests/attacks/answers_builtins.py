"""Replaces float, len, bytes, isinstance and __import__ by ones that lie."""

# ends: fail
import builtins

builtins.float = builtins.len = builtins.bytes = builtins.isinstance = lambda *a: 0
builtins.__import__ = lambda *a, **k: 1 / 0


def euler_eqs(t, w, I):
    return [0, 0, 0]
