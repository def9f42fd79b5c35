"""Worker processes that take jobs from the queue and grade them, each with three warm guests."""
