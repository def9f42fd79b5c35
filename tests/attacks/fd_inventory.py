"""Looks for descriptors that are not its own."""

# ends: pass
import os
import stat

for fd in range(4096):
    try:
        kind = stat.S_IFMT(os.fstat(fd).st_mode)
    except OSError:
        continue
    if fd > 4 or kind in (stat.S_IFSOCK, stat.S_IFREG):
        print("ESCAPED descriptor", fd, oct(kind))
