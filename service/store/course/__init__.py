"""The people of the course, their accounts, and what counts for them: gradebook, overrides, deadlines,
audit log."""
