"""Namespaces and mounts of its own."""

# ends: pass
CALLS = {
    "unshare user": (272, 0x10000000),
    "unshare mounts": (272, 0x20000),
    "setns": (308, 0, 0),
    "mount": (165, b"none", b"/tmp", b"tmpfs", 0, 0),
    "umount": (166, b"/tmp", 0),
    "pivot_root": (155, b"/", b"/"),
    "chroot": (161, b"/"),
    "fsopen": (430, b"tmpfs", 0),
    "open_tree": (428, -100, b"/", 1),
    "move_mount": (429, 0, b"", 0, b"", 0),
}
for label, call in CALLS.items():
    attempt(label, lambda: raw(*call))
