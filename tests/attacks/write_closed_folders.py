"""Folders that nobody may look into or change, with files in them, and files that nobody may read."""

# ends: any
import os
import time


def attack():
    for number, mode in enumerate((0o000, 0o100, 0o200, 0o300, 0o400, 0o500, 0o7000, 0o1300)):
        os.mkdir(f"closed{number}", mode)
        os.mkdir(f"dark{number}", 0o300)
        for inner in range(20):
            os.close(os.open(f"dark{number}/file{inner}", os.O_CREAT | os.O_WRONLY, mode))
            os.mkdir(f"dark{number}/folder{inner}", mode)
    attempt("chmod of the folder", lambda: os.chmod("..", 0))
    time.sleep(1)
    print("ESCAPED the count of its files")


attack()
