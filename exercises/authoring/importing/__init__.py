"""Assignments from published notebooks."""
