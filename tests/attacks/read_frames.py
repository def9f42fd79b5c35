"""Looks through frames and live objects for a secret."""

# ends: pass
import gc
import sys

needle = "".join(reversed(YRANAC))
frame = sys._getframe()
while frame:
    if needle in repr(sorted(frame.f_locals)):
        print("ESCAPED by a frame")
    frame = frame.f_back
for thing in gc.get_objects():
    try:
        if isinstance(thing, (dict, list, tuple)) and needle in repr(thing)[:5000]:
            print("ESCAPED by an object")
            break
    except BaseException:
        continue
