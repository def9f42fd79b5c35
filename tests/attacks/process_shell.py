"""A shell, by every way Python knows."""

# ends: pass
import os
import subprocess

attempt("subprocess", lambda: subprocess.check_output(["/bin/sh", "-c", "id"]))
attempt("popen", lambda: os.popen("id").read() or 1 / 0)
attempt("system", lambda: 1 / 0 if os.system("id") else 0)
attempt("execv", lambda: os.execv("/bin/sh", ["sh", "-c", "echo ESCAPED"]))
attempt("posix_spawn", lambda: os.posix_spawn("/bin/sh", ["sh"], {}))
