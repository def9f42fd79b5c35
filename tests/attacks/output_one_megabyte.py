"""Prints a megabyte and is right."""

# ends: pass
print("x" * (1 << 20))
