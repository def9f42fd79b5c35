"""Reads on where its job came from, and writes there."""

# ends: pass
import os

try:
    os.set_blocking(JOB, False)
except OSError as error:
    print(error)
try:
    print(os.read(JOB, 100000)[:20])
except OSError as error:
    print(error)
attempt("write to the job", lambda: os.write(JOB, b"x"))
attempt("read the result", lambda: os.read(RESULT, 10))
