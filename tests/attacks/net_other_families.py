"""Netlink, packet and virtual machine sockets."""

# ends: pass
import socket

for family in ("AF_NETLINK", "AF_PACKET", "AF_VSOCK", "AF_ALG", "AF_BLUETOOTH"):
    attempt(family, lambda: socket.socket(getattr(socket, family), socket.SOCK_RAW, 0))
