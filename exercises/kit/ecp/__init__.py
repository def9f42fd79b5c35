"""ecp: the small kit of the course notebook: ✓/✗ lines, drawing helpers, animation display.

It is distributed by the course server as ``polhode-kit`` and imported as ``ecp``. (The package called ``ecp`` on the public
index is somebody else's.) Needs numpy; matplotlib is imported only when something is drawn.
"""

from ecp import animate, draw, validate

__all__ = ["animate", "draw", "validate"]
