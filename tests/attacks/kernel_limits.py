"""Higher limits for itself, lower ones for its parent, another priority."""

# ends: pass
import os
import resource

for name in ("AS", "CPU", "NOFILE", "FSIZE", "NPROC", "DATA"):
    which = getattr(resource, f"RLIMIT_{name}")
    attempt(name, lambda: resource.setrlimit(which, (resource.RLIM_INFINITY, resource.RLIM_INFINITY)))
attempt("parent's limits", lambda: resource.prlimit(os.getppid() or 1, resource.RLIMIT_NOFILE, (0, 0)))
attempt("nice", lambda: os.nice(-10))
attempt("parent's priority", lambda: os.setpriority(os.PRIO_PROCESS, os.getppid() or 1, 19))
attempt("parent's processors", lambda: os.sched_setaffinity(os.getppid() or 1, {0}))
attempt("scheduler", lambda: os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1)))
