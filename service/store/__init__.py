"""Durable state in PostgreSQL: submissions, gradings, queue, gradebook, people, tokens, audit log."""
