"""Floods standard error."""

# ends: fail
import os

while True:
    os.write(2, b"B" * 65536)
