"""Who grades: crews of worker processes, each with one warm guest, that take jobs from the queue."""
