"""Commands that run a course's server and act on its database."""
