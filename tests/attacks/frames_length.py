"""A frame that claims four gigabytes."""

# ends: fail
import os

os.write(RESULT, b"A\xff\xff\xff\xff" + b"x" * 100)
os._exit(0)
