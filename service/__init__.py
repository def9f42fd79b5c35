"""The building around the grading: HTTP in front, the database below, the sandbox behind a wall."""
