"""Static analysis of a live notebook: its cells, their statements,
and the names and functions they define.
"""
