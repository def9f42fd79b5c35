"""Arrays whose length, address or strides were changed behind the interpreter, from the 21st answer on."""

# ends: fail
import ctypes

import numpy as np

DATA, SHAPE, STRIDES = 16, 32, 40  # offsets in PyArrayObject
answers = 0


def euler_eqs(t, w, I):
    global answers
    answers += 1
    rates = np.array(-np.cross(w, np.asarray(I) * w) / np.asarray(I))
    if answers > 20:
        offset, value = ((DATA, id(np.ndarray)), (SHAPE, 2**40), (STRIDES, -8))[answers % 3]
        field = ctypes.c_void_p.from_address(id(rates) + offset)
        if offset != DATA:  # these two point to the numbers
            field = ctypes.c_ssize_t.from_address(field.value)
        field.value = value
    return rates
