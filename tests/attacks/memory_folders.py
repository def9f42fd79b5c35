"""Fills whatever it can write to outside of its own folder."""

# ends: pass
import os

written = 0
folders = [
    "/tmp",
    "/polhode/scratch",
    "/polhode/scratch/0",
    "/polhode/matplotlib",
    "/dev/shm",
    "/var/tmp",
    "/run",
    "/",
]
for folder in [*folders, os.environ.get("MPLCONFIGDIR", "/"), os.path.dirname(os.getcwd())]:
    for i in range(100):
        try:
            with open(f"{folder}/fill{i}", "wb") as f:
                written += 1 + f.write(b"x" * (1 << 20))
        except OSError:
            break
if written:
    print("ESCAPED wrote", written)
