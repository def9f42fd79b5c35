"""Links, names and folders for a trusting reader to follow."""

# ends: pass
import os

for folder in ("/tmp", "/polhode/scratch", "..", "/polhode/matplotlib"):
    attempt(f"symlink {folder}", lambda: os.symlink("/etc/passwd", folder + "/result.json"))
    attempt(f"link {folder}", lambda: os.link(os.__file__, folder + "/hard"))
    attempt(f"fifo {folder}", lambda: os.mkfifo(folder + "/fifo"))
    attempt(f"mkdir {folder}", lambda: os.makedirs(folder + "/a"))
