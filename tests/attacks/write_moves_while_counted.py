"""Moves folders into each other and away while they are counted."""

# ends: pass
import os
import time

os.makedirs("a/b/c/d")
os.makedirs("e")
until = time.monotonic() + 0.7
while time.monotonic() < until:
    os.rename("a/b", "e/b")
    os.rename("a", "e/b/c/a")
    os.rename("e/b/c/a", "a")
    os.rename("e/b", "a/b")
    os.rmdir("e")
    open("e", "w").close()
    os.remove("e")
    os.mkdir("e")
attempt("a folder into itself", lambda: os.rename("a", "a/b/c/d/a"))
attempt("out of its folder", lambda: os.rename("a", "../evil"))
