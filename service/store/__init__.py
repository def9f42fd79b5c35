"""What must not be lost: submissions and results in PostgreSQL, embedded by default."""
