"""The student's side of the course server: local checks, submitting, and the account."""
