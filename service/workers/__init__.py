"""Worker processes that take jobs from the queue and grade them, each with one warm guest."""
