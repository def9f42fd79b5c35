"""Goes to other folders and writes there, and moves or removes its own."""

# ends: pass
import os
import tempfile

import numpy

home = os.getcwd()
open("own", "w").close()
os.mkdir("inner")
for folder in (
    "/",
    "..",
    "../..",
    "/tmp",
    "/dev",
    "/polhode/data",
    SECRETS,
    os.path.dirname(numpy.__file__),
    os.path.dirname(os.__file__),
):
    attempt(f"create by path in {folder}", lambda: open(os.path.join(folder, "evil"), "w"))
    attempt(f"move to {folder}", lambda: os.rename("own", os.path.join(folder, "evil")))
    attempt(f"move a folder to {folder}", lambda: os.rename("inner", os.path.join(folder, "evil")))
    attempt(f"nameless in {folder}", lambda: os.open(folder, os.O_TMPFILE | os.O_RDWR))
    try:
        way = os.open(folder, os.O_PATH)
        os.chdir(folder)
    except OSError:
        continue
    attempt(f"create in {folder}", lambda: open("evil", "w"))
    attempt(
        f"create below a descriptor of {folder}",
        lambda: os.open("evil", os.O_CREAT | os.O_WRONLY, dir_fd=way),
    )
    attempt(f"folder in {folder}", lambda: os.mkdir("evil"))
    attempt(f"temporary file in {folder}", lambda: tempfile.mkstemp(dir="."))
    os.close(way)
    os.chdir(home)
attempt("remove its own folder", lambda: os.rmdir(home))
attempt("rename its own folder", lambda: os.rename(home, home + "evil"))
attempt("replace its own folder", lambda: os.rename("inner", home))
for path in (os.__file__, numpy.__file__):
    attempt(f"remove {path}", lambda: os.remove(path))
    attempt(f"take {path}", lambda: os.rename(path, "taken"))
    attempt(f"replace {path}", lambda: os.replace("own", path))
os.chdir(home)
