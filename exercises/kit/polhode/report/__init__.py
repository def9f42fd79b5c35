"""The report of a grading: as data, as text and HTML, and its pictures."""
