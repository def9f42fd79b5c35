"""Writes into the libraries, the interpreter and the server's code."""

# ends: pass
import os
import sys

import numpy

inside = (os.path.dirname(numpy.__file__) + "/evil.py", os.__file__, sys.executable or "/polhode/x", "/polhode/guest/play.py")
for path in (*inside, HOST_CODE + "/service/cli/__main__.py", HOST_CODE + "/service/sandbox/guest/run_scenes.py"):
    attempt(path, lambda: open(path, "a"))
