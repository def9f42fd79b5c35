"""The autograder for Gradescope: the zip that a course uploads, and what of it runs there for each submission."""
