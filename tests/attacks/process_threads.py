"""Ten thousand threads."""

# ends: pass
import threading
import time

started = 0
try:
    for _ in range(10000):
        threading.Thread(target=time.sleep, args=(60,), daemon=True).start()
        started += 1
except RuntimeError as error:
    print(error)
if started:
    print("ESCAPED", started, "threads")
