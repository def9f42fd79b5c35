"""Grades as files: our own CSV and JSON, and what other gradebooks import. Pure: no HTTP, no SQL, no clock."""
