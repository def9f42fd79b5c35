"""Grading itself: pure, without web, database or clock. A submission in, a report out."""
