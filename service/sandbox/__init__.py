"""The sandbox. ``guest`` is the code that runs inside it; the other modules run on the host."""
