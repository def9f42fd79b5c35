"""Notebook 2.6, "Rigid-Body Rotation and the Spinning Top"."""
