"""Plumbing of HTTP that API and pages share: errors, middleware, metrics, templates, live updates."""
