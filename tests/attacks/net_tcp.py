"""TCP, out and in."""

# ends: pass
import socket

attempt("connect", lambda: socket.create_connection(("127.0.0.1", TCP_PORT), timeout=1))
attempt("listen", lambda: socket.create_server(("127.0.0.1", 0)))
attempt("version 6", lambda: socket.socket(socket.AF_INET6, socket.SOCK_STREAM))
