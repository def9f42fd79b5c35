"""A live notebook read as text: its cells, the statements in them, the names and codes those make."""
