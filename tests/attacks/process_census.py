"""Which processes there are outside, and how much they have computed."""

# ends: pass
import os
import resource

for pid in (1, os.getppid() or 1):
    clock = ~pid << 3 | 2  # as clock_getcpuclockid has it
    attempt(f"CPU time of {pid}", lambda: raw(228, clock, _ctypes.create_string_buffer(16)))
    attempt(f"group of {pid}", lambda: os.getpgid(pid))
    attempt(f"session of {pid}", lambda: os.getsid(pid))
    attempt(f"processors of {pid}", lambda: os.sched_getaffinity(pid))
    attempt(f"limits of {pid}", lambda: resource.prlimit(pid, resource.RLIMIT_NOFILE))
