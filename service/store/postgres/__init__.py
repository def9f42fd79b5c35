"""An embedded PostgreSQL server, and backups made with its programs."""
