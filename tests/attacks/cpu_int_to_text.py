"""Quadratic conversion of enormous integers."""

# ends: fail slow
import sys

sys.set_int_max_str_digits(0)


def euler_eqs(t, w, I):
    while True:
        str(7**3000000)
