"""A datagram, and a name."""

# ends: pass
import socket

attempt("datagram", lambda: socket.socket(socket.AF_INET, socket.SOCK_DGRAM).sendto(b"out", ("127.0.0.1", UDP_PORT)))
attempt("name", lambda: socket.getaddrinfo("localhost.invalid", 80))
