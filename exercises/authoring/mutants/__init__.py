"""Wrong versions of a right solution."""
