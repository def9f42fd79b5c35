"""The queue: jobs, runs of gradings, workers, and what the staff sees of it."""
