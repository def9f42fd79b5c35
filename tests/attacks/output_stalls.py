"""Half a frame, then silence."""

# ends: fail slow
import os
import time

os.write(RESULT, b"J\x10\x00")
time.sleep(1e6)
