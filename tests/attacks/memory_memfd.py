"""Memory in a file that no limit counts."""

# ends: pass
import os


def fill():
    fd = os.memfd_create("x")
    for _ in range(600):
        os.write(fd, b"x" * (1 << 20))


attempt("memfd", fill)
