"""Text of a submission, made safe to display."""

from typing import Any

# they reorder the surrounding text
BIDI_CONTROLS = "\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069"
MOST_TEXT = 8 * 1024  # characters
_BIDI = frozenset(BIDI_CONTROLS)


def text(value: Any, most: int = MOST_TEXT) -> str:
    """Return untrusted text made safe to display: bounded, without bidi controls and control characters (but
    newline, tab).
    """
    bounded = str(value)[:most]
    return "".join(c if c in "\n\t" or (c.isprintable() and c not in _BIDI) else "\ufffd" for c in bounded)
