"""The kernel's odder doors."""

# ends: pass
CALLS = {
    "bpf": (321, 0, 0, 0),
    "perf_event_open": (298, 0, 0, -1, -1, 0),
    "userfaultfd": (323, 1),
    "keyctl": (250, 0, -3, 0),
    "add_key": (248, b"user", b"x", b"y", 1, -3),
    "request_key": (249, b"user", b"x", 0, 0),
    "io_uring_setup": (425, 1, 0),
    "modify_ldt": (154, 0, 0, 0),
    "syslog": (103, 10, 0, 0),
    "reboot": (169, 0, 0, 0, 0),
    "init_module": (175, 0, 0, b""),
    "swapon": (167, b"/x", 0),
    "iopl": (172, 3),
    "clock_settime": (227, 0, 0),
    "settimeofday": (164, 0, 0),
    "sethostname": (170, b"x", 1),
    "memfd_secret": (447, 0),
    "fanotify_init": (300, 0, 0),
    "inotify_init1": (294, 0),
    "personality": (135, 0x0040000),
    "seccomp": (317, 1, 0, 0),
    "process_mrelease": (448, 0, 0),
    "mlockall": (151, 3),
    "splice": (275, 0, 0, 1, 0, 1, 0),
    "vmsplice": (278, 1, 0, 0, 0),
    "landlock_create_ruleset": (444, 0, 0, 1),
    "quotactl": (179, 0, 0, 0, 0),
    "acct": (163, b"/x"),
    "kexec_load": (246, 0, 0, 0, 0),
    "name_to_handle_at": (303, -100, b"/", 0, 0, 0),
    "open_by_handle_at": (304, 0, 0, 0),
}
for label, call in CALLS.items():
    attempt(label, lambda: raw(*call))
