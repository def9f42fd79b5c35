"""Modes, owners, times, names and lengths of files that are there."""

# ends: pass
import os

for path in (os.__file__, "/dev/null", "/polhode"):
    attempt(f"chmod {path}", lambda: os.chmod(path, os.stat(path).st_mode & 0o7777))
    attempt(f"chown {path}", lambda: os.chown(path, os.getuid(), os.getgid()))
    attempt(f"utime {path}", lambda: os.utime(path))
    attempt(f"truncate {path}", lambda: os.truncate(path, os.stat(path).st_size))
    attempt(f"setxattr {path}", lambda: os.setxattr(path, "user.x", b"x"))
