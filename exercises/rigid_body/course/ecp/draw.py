"""The colours of a course notebook's figures."""

INK, ACCENT, SOFT = "#16213e", "#c0851a", "#46506b"  # of text, of what matters, of what does not
