"""Undistorted 3-D axes, arrows, and a box in any attitude."""

from polhode.report.figure_parts import FACE_COLORS, arrow, box_polys, cube_axes, legend_above

__all__ = ["FACE_COLORS", "arrow", "box_polys", "cube_axes", "legend_above"]
