"""The wall and both of its sides. ``guest`` is everything that crosses; the rest stays with the host."""
