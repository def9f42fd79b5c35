"""Whether the server's files are there, how long and how old."""

# ends: pass
import os

attempt("stat", lambda: os.stat(SECRETS + "/app.db"))
attempt("access", lambda: None if os.access(SECRETS + "/app.db", os.F_OK) else 1 / 0)
attempt("readlink", lambda: os.readlink(SECRETS + "/link"))
