"""Stored submissions with their results and files."""
