"""System calls numbered for x32."""

# ends: fail
attempt("fork", lambda: raw(0x40000000 | 57))
attempt("socket", lambda: raw(0x40000000 | 41, 2, 1, 0))
