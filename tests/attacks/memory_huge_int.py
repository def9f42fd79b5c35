"""An integer of a thousand million bits."""

# ends: fail
1 << (1 << 33)
