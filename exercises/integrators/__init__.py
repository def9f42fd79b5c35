"""Integrators: how fast and how accurate four steppers are, and where they fail."""
