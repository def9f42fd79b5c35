"""Devices, pipes and sockets in its folder, for a reader to wait for or to open."""

# ends: pass
import os
import socket
import stat

kinds = {"fifo": stat.S_IFIFO, "character": stat.S_IFCHR, "block": stat.S_IFBLK, "socket": stat.S_IFSOCK}
for name, kind in kinds.items():
    for device in (0, os.makedev(1, 3), os.makedev(8, 0), os.makedev(5, 2)):
        attempt(f"{name} {device}", lambda: os.mknod("node", kind | 0o666, device))
        attempt(f"raw {name} {device}", lambda: raw(259, -100, b"node", kind | 0o666, device))
attempt("mkfifo", lambda: os.mkfifo("node"))
attempt("bind", lambda: socket.socket(socket.AF_UNIX).bind("node"))
attempt("it exists", lambda: os.lstat("node"))
