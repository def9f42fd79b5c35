"""Floods the results."""

# ends: fail
import os

while True:
    os.write(RESULT, bytes(65536))
