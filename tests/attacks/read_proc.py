"""What the kernel tells of processes."""

# ends: pass
import glob
import os

parent = os.getppid()
own = (
    "/proc/self/maps",
    "/proc/self/mem",
    "/proc/self/environ",
    "/proc/kallsyms",
    "/proc/version",
    "/proc/mounts",
    "/proc/net/tcp",
)
for path in (*own, f"/proc/{parent}/mem", f"/proc/{parent}/environ", "/proc/1/cmdline", "/sys/class/net"):
    attempt(path, lambda: open(path, "rb").read(64))
if glob.glob("/proc/*/cmdline"):
    print("ESCAPED a list of processes")
