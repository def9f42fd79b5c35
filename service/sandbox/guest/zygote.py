"""The zygote: a warm process that imports the libraries once and forks a child for each play.

It reads no submission and has no secret.

For each play the host sends three descriptors (job, result, output) and the child's limit of CPU time. The zygote returns a pidfd,
with which the host can kill the child, and after the child's exit its wait status and the CPU time that it used. Its first message
is READY and its identity as JSON.
"""

import gc
import importlib
import json
import os
import socket
import struct
import sys
import traceback
from typing import Any

LOCKDOWN_FAILED = 97
READY = b"ready"
PLAY = struct.Struct("<i")  # limit of CPU time in seconds
REAPED = struct.Struct("<id")  # wait status, CPU time in seconds
WARM = (
    "ecp.animation_recording",
    "ecp.kinds",
    "guest.lockdown",
    "guest.run_scenes",
    "matplotlib.animation",
    "matplotlib.backends.backend_agg",
    "matplotlib.pyplot",
    "mpl_toolkits.mplot3d.art3d",
    "scipy.integrate",
    "scipy.linalg",
    "scipy.optimize",
    "scipy.spatial.transform",
)


def main(
    control_fd: int, *, user: int | None, layers: list[str], readable: list[str], listable: list[str], folders: list[str]
) -> None:
    """Fork a child for each play that the control socket asks for, until the host closes it."""
    control = socket.socket(fileno=control_fd)
    from .lockdown import Layers, die_with_parent, drop_privileges, identity

    die_with_parent()
    _warm_up()
    prepared = Layers(layers, readable, listable, folders)  # before dropping privileges: only root may be able to open the paths
    drop_privileges(user)
    die_with_parent()  # again: the change of user has cleared it
    gc.collect()
    gc.freeze()
    control.send(READY + json.dumps(identity()).encode())
    while True:
        play, fds, _, _ = socket.recv_fds(control, PLAY.size, 3)
        if len(fds) < 3:
            return
        child = os.fork()
        if child == 0:
            _child(prepared, *PLAY.unpack(play), *fds)
        for fd in fds:
            os.close(fd)
        handle = os.pidfd_open(child)
        socket.send_fds(control, [b"child"], [handle])
        os.close(handle)
        _, status, used = os.wait4(child, 0)
        control.send(REAPED.pack(status, used.ru_utime + used.ru_stime))


def _warm_up() -> None:
    for name in WARM:
        importlib.import_module(name)
    sys.modules["matplotlib"].use("Agg")
    sys.modules["scipy.integrate"].solve_ivp(lambda t, y: -y, (0.0, 1.0), [1.0], method="DOP853")


def _child(layers: Any, cpu_s: int, job: int, result: int, output: int) -> None:
    code = LOCKDOWN_FAILED
    try:
        devnull = os.open(os.devnull, os.O_RDONLY)
        layers.apply({0: devnull, 1: output, 2: output, 3: job, 4: result}, cpu_s)
        from . import run_scenes

        code = 1
        run_scenes.run(3, 4)
        code = 0
    except BaseException:
        if code == LOCKDOWN_FAILED:
            traceback.print_exc()
    finally:
        try:
            sys.stdout.flush()
        except BaseException:
            pass
        os._exit(code)
