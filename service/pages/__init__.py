"""The HTML pages of students and of staff."""
