"""People of the course: roster, logins, tokens and notes."""
