"""Starts programs by IPython's own ways to do so."""

# ends: pass
import os

shell = get_ipython()
super_of = type(shell).__mro__[1]
attempt("system", lambda: shell.system("id") or 1 / 0)
attempt("getoutput", lambda: shell.getoutput("id")[0])
attempt("system_raw", lambda: shell.system_raw("id") or shell.user_ns["_exit_code"] and 1 / 0)
attempt("system_piped", lambda: super_of.system_piped(shell, "id") or shell.user_ns["_exit_code"] and 1 / 0)
attempt("script", lambda: shell.run_cell_magic("script", "/bin/sh", "id > left") or os.stat("left"))
