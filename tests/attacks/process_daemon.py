"""A process that outlives the submission."""

# ends: pass
import os
import time

try:
    if os.fork() == 0:
        os.setsid()
        if os.fork() == 0:
            time.sleep(30)
        os._exit(0)
    print("ESCAPED fork")
except OSError as error:
    print(error)
