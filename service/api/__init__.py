"""The JSON API, version 1, and what it returns: submissions, reports, figures, exports, health."""
