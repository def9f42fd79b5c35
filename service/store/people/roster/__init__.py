"""Rosters: read a file of any tool, compare it with the course, ask what is not clear, and import it."""
