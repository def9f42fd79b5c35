"""Signals by the raw calls."""

# ends: pass
import ctypes
import os

parent, info = os.getppid() or 1, ctypes.create_string_buffer(128)
CALLS = {
    "tkill": (200, parent, 9),
    "tgkill": (234, parent, parent, 9),
    "rt_sigqueueinfo": (129, parent, 9, info),
    "rt_tgsigqueueinfo": (297, parent, parent, 9, info),
    "pidfd_open": (434, parent, 0),
    "pidfd_send_signal": (424, 0, 9, 0, 0),
    "process_madvise": (440, 0, 0, 0, 0, 0),
    "pidfd_getfd": (438, 0, 0, 0),
}
for label, call in CALLS.items():
    attempt(label, lambda: raw(*call))
