"""HTTP infrastructure shared by API and pages: errors, middleware, metrics, templates, live updates."""
