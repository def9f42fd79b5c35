"""The pages of a class for one assignment, with their statistics and charts."""
