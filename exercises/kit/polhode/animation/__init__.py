"""Recording what a submission's animations draw, and showing them in a notebook."""
