"""Sockets of the machine: by path, abstract, in pairs."""

# ends: pass
import socket


def send(address):
    s = socket.socket(socket.AF_UNIX)
    s.connect(address)
    s.send(b"out")


attempt("path", lambda: send(SECRETS + "/canary.sock"))
attempt("abstract", lambda: send(ABSTRACT))
attempt("pair", lambda: socket.socketpair())
