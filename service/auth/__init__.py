"""Authentication and authorization: sessions, tokens, passwords, OpenID Connect, JupyterHub, roles,
rate limits.
"""
