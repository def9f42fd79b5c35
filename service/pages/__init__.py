"""HTML pages for students and staff."""
