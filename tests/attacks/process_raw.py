"""Processes by the raw calls."""

# ends: pass
CALLS = {"fork": (57,), "vfork": (58,), "clone": (56, 17, 0, 0, 0, 0), "clone3": (435, 0, 0), "execve": (59, b"/bin/sh", 0, 0)}
for label, call in CALLS.items():
    attempt(label, lambda: raw(*call))
attempt("execveat", lambda: raw(322, -100, b"/bin/sh", 0, 0, 0))
