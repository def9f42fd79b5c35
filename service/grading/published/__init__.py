"""The cells of a published notebook, which run in place of the student's copies."""
