"""Requests to the course server from every Python that a notebook runs in."""
