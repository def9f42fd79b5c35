"""A loop in C that looks at no signal."""

# ends: fail slow
import itertools


def euler_eqs(t, w, I):
    return sum(itertools.count())
