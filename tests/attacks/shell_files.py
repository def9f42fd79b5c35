"""Writes by IPython's magics outside of its own folder, and reads what it must not."""

# ends: pass
import os

shell = get_ipython()
for folder in ("/", "/tmp", "/polhode", "/polhode/code/guest", HOST_CODE):
    path = f"{folder}/left_by_a_magic.py"
    attempt(f"writefile {folder}", lambda: shell.run_cell_magic("writefile", path, "x = 1") or os.stat(path))
    attempt(f"logstart {folder}", lambda: shell.run_line_magic("logstart", path) or os.stat(path))
    attempt(f"save {folder}", lambda: shell.run_line_magic("save", f"-f {path} 1") or os.stat(path))
attempt("cat", lambda: open(f"{SECRETS}/app.db").read())
attempt("load", lambda: shell.run_line_magic("load", f"{SECRETS}/app.db"))
