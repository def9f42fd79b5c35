"""What students get: the notebook, the public side of an assignment, and the kit."""
