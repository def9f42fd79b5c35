"""Sends a .npy header of a trillion numbers, and a pickle."""

# ends: fail
import os
import pickle
import struct

header = b"\x93NUMPY\x01\x00" + b"{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000000,)}\n"
for body in (header, pickle.dumps(print)):
    os.write(RESULT, struct.pack("<cI", b"A", len(body)) + body)
os._exit(0)
