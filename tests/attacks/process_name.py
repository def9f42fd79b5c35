"""A name of its own in the host's list of processes."""

# ends: pass
PR_SET_NAME = 15
attempt("name", lambda: raw(157, PR_SET_NAME, b"\x1b[2Jsshd\n", 0, 0, 0))
attempt("name, by its file", lambda: open("/proc/self/comm", "w"))
