"""Signals every process, its group, and its parent."""

# ends: pass
import os
import signal

attempt("everyone", lambda: os.kill(-1, signal.SIGTERM))
attempt("group", lambda: os.killpg(0, signal.SIGTERM))
attempt("parent", lambda: os.kill(os.getppid() or 1, signal.SIGSTOP))
