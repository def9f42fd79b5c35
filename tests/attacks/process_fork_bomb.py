"""Forks as long as it can."""

# ends: pass
import os

while True:
    try:
        os.fork()
        print("ESCAPED fork")
    except OSError as error:
        print(error)
        break
