"""The people of the course and their accounts, gradebook, overrides, deadlines and audit log."""
