"""Kills the processes with numbers like its own."""

# ends: pass
import os

me = os.getpid()
for pid in range(max(1, me - 200), me + 200):
    if pid != me:
        try:
            os.kill(pid, 9)
            print("ESCAPED killed", pid)
        except OSError:
            pass
