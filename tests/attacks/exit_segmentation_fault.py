"""Reads address zero."""

# ends: fail
import ctypes


def euler_eqs(t, w, I):
    return ctypes.string_at(0)
