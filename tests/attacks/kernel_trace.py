"""Traces its parent and reads its memory."""

# ends: pass
import ctypes
import os

parent = os.getppid() or 1
buffer = ctypes.create_string_buffer(64)
vector = (ctypes.c_size_t * 2)(ctypes.addressof(buffer), 64)
attempt("ptrace attach", lambda: raw(101, 16, parent, 0, 0))
attempt("ptrace traceme", lambda: raw(101, 0, 0, 0, 0))
attempt("process_vm_readv", lambda: raw(310, parent, vector, 1, vector, 1, 0))
attempt("process_vm_writev", lambda: raw(311, parent, vector, 1, vector, 1, 0))
attempt("kcmp", lambda: raw(312, os.getpid(), parent, 0, 0, 0))
