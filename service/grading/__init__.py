"""Grading: a submission in, a report out, without web, database or clock."""
