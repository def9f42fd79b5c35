"""Links to files outside, to the folders of other submissions, and to open files."""

# ends: pass
import os

targets = [
    "/etc/passwd",
    "/",
    "..",
    "../..",
    os.path.dirname(os.getcwd()),
    os.__file__,
    SECRETS,
    "/proc/self/fd/3",
]
for target in targets:
    attempt(f"symlink to {target}", lambda: os.symlink(target, "way"))
    attempt(f"raw symlink to {target}", lambda: raw(266, target.encode(), -100, b"way"))
    attempt(f"link to {target}", lambda: os.link(target, "way"))
    attempt(f"raw link to {target}", lambda: raw(265, -100, target.encode(), -100, b"way", 0x400))
    attempt(f"way to {target}", lambda: os.lstat("way"))
open("own", "w").close()
attempt("second name of a file", lambda: os.link("own", "other"))
attempt(
    "file without a name", lambda: os.link(f"/proc/self/fd/{os.open('.', os.O_TMPFILE | os.O_RDWR)}", "named")
)
attempt("whiteout", lambda: raw(316, -100, b"own", -100, b"white", 4))
os.remove("own")
for folder in ("..", "../..", "/tmp", os.path.dirname(os.path.dirname(os.getcwd()))):
    attempt(f"neighbours in {folder}", lambda: os.listdir(folder))
