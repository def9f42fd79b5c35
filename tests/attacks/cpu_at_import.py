"""Loops before it has defined anything."""

# ends: fail slow
while True:
    pass
