"""Leaves files, shared memory and queues behind, not in its own folder."""

# ends: pass
import os
import tempfile
from multiprocessing import shared_memory

folders = [
    "/tmp",
    "/polhode",
    "/polhode/scratch",
    "/polhode/scratch/0",
    "/polhode/matplotlib",
    "/dev/shm",
    "/var/tmp",
    "..",
]
for folder in [*folders, os.environ.get("MPLCONFIGDIR", "/")]:
    attempt(folder, lambda: open(folder + "/left_behind", "w"))
attempt("temporary file", lambda: tempfile.mkstemp(dir=".."))
attempt("shared memory", lambda: shared_memory.SharedMemory("polhode-left", create=True, size=4096))
attempt("shmget", lambda: raw(29, 0x1234, 4096, 0o1666))
attempt("semget", lambda: raw(64, 0x1234, 1, 0o1666))
attempt("msgget", lambda: raw(68, 0x1234, 0o1666))
attempt("mq_open", lambda: raw(240, b"polhode", 0o102, 0o600, 0))
