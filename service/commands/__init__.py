"""Commands for who operates a server: its database, its queue, its assignments."""
