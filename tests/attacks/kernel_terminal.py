"""Types into a terminal, and talks the kernel out of its promises."""

# ends: pass
import fcntl

for fd in (0, 1, 2):
    attempt(f"TIOCSTI {fd}", lambda: fcntl.ioctl(fd, 0x5412, b"x"))
OPTIONS = {
    "dumpable": (4, 1),
    "death signal": (1, 0),
    "time stamp counter": (26, 2),
    "subreaper": (36, 1),
    "speculation": (53, 0),
    "memory map": (35, 1),
    "keep capabilities": (8, 1),
    "seccomp": (22, 1),
    "transparent huge pages": (41, 1),
}
for label, option in OPTIONS.items():
    attempt(label, lambda: raw(157, *option, 0, 0, 0))
