"""Fills its folder with empty files and folders, and waits."""

# ends: any
import os
import time


def attack():
    made = 0
    for number in range(5000):
        try:
            os.makedirs(f"fill/{number % 50}/{number}")
            open(f"fill/{number % 50}/{number}.txt", "w").close()
            made += 2
        except OSError:
            break
    time.sleep(1)
    if made > 1100:
        print("ESCAPED made", made)


attack()
