"""The server around the grading core: HTTP, database, sandbox and command line."""
