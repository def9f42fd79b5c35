"""A course package of our own under the name of the course's: the few names that the notebooks of this
assignment use. A course's own package ``ecp`` comes before it.
"""

from ecp import animate, draw, validate
from ecp.style import footer, header, use_style

__all__ = ["animate", "draw", "footer", "header", "use_style", "validate"]
