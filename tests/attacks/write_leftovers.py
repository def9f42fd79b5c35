"""Leaves files for the next submission, looks for those of the last one, and keeps some open without a name."""

# ends: pass
import mmap
import os

for path, folders, files in os.walk("."):
    if "left_by_another" in (*folders, *files):
        print("ESCAPED found", path)
try:
    import left_module
except ImportError:
    pass
else:
    print("ESCAPED imported", left_module.home)
os.makedirs("left_by_another/.ipython/profile_default/startup")
for name in (
    "left_module.py",
    "sitecustomize.py",
    "matplotlibrc",
    "ipython_config.py",
    "guest.pth",
    ".pythonstartup",
):
    with open(name, "w") as file:
        file.write(f"home = {os.getcwd()!r}")
kept = [open(f"kept{number}", "wb+") for number in range(5)]
for number, file in enumerate(kept):
    file.write(bytes(1 << 16))
    file.flush()
    mapped = mmap.mmap(file.fileno(), 1 << 16)
    os.remove(f"kept{number}")
for file in kept:
    file.close()
