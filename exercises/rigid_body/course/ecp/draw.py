"""Undistorted 3-D axes, arrows, and a box in any attitude."""

from polhode.report.figure_parts import FACE_COLORS, arrow, box_polys, cube_axes, legend_above

INK, ACCENT, SOFT = "#16213e", "#c0851a", "#46506b"  # of text, of what matters, of what does not

__all__ = ["ACCENT", "FACE_COLORS", "INK", "SOFT", "arrow", "box_polys", "cube_axes", "legend_above"]
