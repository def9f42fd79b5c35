"""A call of another processor mode, which kills."""

# ends: fail
raw(0x40000000 | 39)
