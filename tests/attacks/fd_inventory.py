"""Looks for descriptors that are not its own, and for a way out of the folders that root opened for another user."""

# ends: pass
import os
import stat

for fd in range(4096):
    try:
        kind = stat.S_IFMT(os.fstat(fd).st_mode)
    except OSError:
        continue
    if kind in (stat.S_IFSOCK, stat.S_IFREG) or (fd > 4 and kind != stat.S_IFDIR):
        print("ESCAPED descriptor", fd, oct(kind))
    if kind == stat.S_IFDIR:
        for up in range(1, 10):
            for below in ("", "etc/passwd", "etc/shadow", ".bashrc", ".profile", "root/.bashrc", "root/.profile"):
                try:
                    os.close(os.open(f"{'../' * up}{below}", os.O_RDONLY, dir_fd=fd))
                    print("ESCAPED read", up, below)
                except OSError:
                    pass
