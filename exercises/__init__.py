"""Assignments: modules here are the declaration and its tools; each folder is one assignment and is found by
its name.
"""
