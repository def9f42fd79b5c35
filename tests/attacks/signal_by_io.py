"""Lets the kernel signal others when a pipe is written to."""

# ends: pass
import fcntl
import os

attempt("owner", lambda: fcntl.fcntl(RESULT, 8, os.getppid() or 1))
attempt("signal", lambda: fcntl.fcntl(RESULT, 10, 9))
attempt("lease", lambda: fcntl.fcntl(RESULT, 1024, 0))
attempt("notify", lambda: fcntl.fcntl(RESULT, 1026, 1))
attempt("pipe size", lambda: fcntl.fcntl(RESULT, 1031, 1 << 20))
