"""JSON API version 1: submissions, reports, figures, exports, health and metrics."""
