"""The server's code, database and other submissions."""

# ends: pass
for path in ("/expected.json", "/app.db", "/../secrets/app.db"):
    attempt(path, lambda: open(SECRETS + path).read())
for path in ("/service/grading/grade.py", "/exercises/rigid_body/draws.py", "/reference/exact.py", "/pyproject.toml"):
    attempt(path, lambda: open(HOST_CODE + path).read())
attempt("through proc", lambda: open("/proc/1/root" + SECRETS + "/expected.json").read())
attempt("through the folder", lambda: open("/proc/self/cwd" + SECRETS + "/app.db").read())
attempt("server's folder", lambda: __import__("os").listdir(SECRETS))
