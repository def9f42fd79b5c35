"""Files that are huge because most of them is a hole, and maps of them."""

# ends: pass
import mmap
import os


def beyond(size):
    with open("hole", "wb") as file:
        file.seek(size)
        file.write(b"x")


for size in (1 << 25, 1 << 33, 1 << 40, (1 << 63) - 2):
    attempt(f"write at {size}", lambda: beyond(size))
    attempt(f"ftruncate {size}", lambda: open("hole", "wb").truncate(size))
    attempt(f"map {size}", lambda: mmap.mmap(os.open("hole", os.O_RDWR | os.O_CREAT), size))
    attempt(f"fallocate {size}", lambda: os.posix_fallocate(os.open("hole", os.O_RDWR | os.O_CREAT), 0, size))
attempt("fallocate that keeps the size", lambda: raw(285, os.open("hole", os.O_RDWR), 1, 0, 1 << 30))
os.remove("hole")
