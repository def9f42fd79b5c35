"""Catastrophic backtracking of a regular expression."""

# ends: fail slow
import re


def euler_eqs(t, w, I):
    return re.match(r"(a+)+$", "a" * 64 + "b")
