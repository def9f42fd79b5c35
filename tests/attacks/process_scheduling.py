"""Scheduling and limits of its own and of its parent: idle, on one processor, or nearly no descriptors."""

# ends: pass
import os
import resource

IOPRIO_SET, IOPRIO_WHO_PROCESS, IDLE = 251, 1, 3 << 13
for pid in (0, os.getppid() or 1):
    attempt(f"idle {pid}", lambda: os.sched_setscheduler(pid, os.SCHED_IDLE, os.sched_param(0)))
    attempt(f"nice {pid}", lambda: os.setpriority(os.PRIO_PROCESS, pid, 19))
    attempt(f"one processor {pid}", lambda: os.sched_setaffinity(pid, {0}))
    attempt(f"input and output last {pid}", lambda: raw(IOPRIO_SET, IOPRIO_WHO_PROCESS, pid, IDLE))
attempt("limits", lambda: resource.prlimit(os.getppid() or 1, resource.RLIMIT_NOFILE, (8, 8)))
attempt("group", lambda: os.setpgid(os.getppid() or 1, 0))
