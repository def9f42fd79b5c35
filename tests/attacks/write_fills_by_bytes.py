"""Fills its folder with as many bytes as it can, and waits."""

# ends: any
import time


def attack():
    written = 0
    for number in range(64):
        try:
            with open(f"fill{number}", "wb") as file:
                written += file.write(bytes(8 << 20))
        except OSError:
            break
    time.sleep(1)
    if written > 40 << 20:
        print("ESCAPED wrote", written)


attack()
