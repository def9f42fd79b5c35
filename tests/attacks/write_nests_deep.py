"""Folders nested deeper than a path can be long and a stack can be deep, with a file in the last one."""

# ends: any
import os
import time


def attack():
    home, depth = os.getcwd(), 0
    while depth < 20000:
        try:
            os.mkdir("d" * 200)
            os.chdir("d" * 200)
            depth += 1
        except OSError:
            break
    open("left", "w").close()
    os.chdir(home)
    time.sleep(1)
    if depth > 64:
        print("ESCAPED nested", depth)


attack()
