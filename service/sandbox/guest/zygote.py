"""The zygote: a warm process that imports the libraries once and forks a child for each play.

It reads no submission and has no secret.

For each play the host sends three descriptors (job, result, output) and the child's limit of CPU time. The zygote returns a pidfd,
with which the host can kill the child, and after the child's exit its wait status and the CPU time that it used. With a fourth
descriptor, a job of reference functions, a second child holds these and answers calls of the first one (calls.py): it gets the
same layers and limits, its pidfd and wait status are returned too, and it does not survive the first. The zygote's first message is
READY and its identity as JSON. With a single descriptor, a control socket, it forks a copy of itself that obeys that socket.
A zygote that imports SciPy and matplotlib later does so when it receives IMPORT and the name of one, and answers READY.
"""

import gc
import importlib
import json
import os
import select
import signal
import socket
import struct
import sys
import traceback
from typing import Any

NEEDED = {"scipy": 95, "matplotlib": 96}  # exit codes of a child that uses a library which the zygote has not imported
LOCKDOWN_FAILED = 97  # exit code
READY = b"ready"
PLAY = struct.Struct("<i")  # limit of CPU time in seconds
REAPED = struct.Struct("<iid")  # wait status, that of the child with the reference functions or 0, CPU time of both in seconds
END_S = 0.5  # for the child with the reference functions to read what is left and to exit
WARM = (
    "ecp.animation_recording",
    "ecp.kinds",
    "guest.lockdown",
    "guest.reference",
    "guest.run_scenes",
)
MODULES = {
    "scipy": ("scipy.integrate", "scipy.linalg", "scipy.optimize", "scipy.spatial.transform"),
    "matplotlib": ("matplotlib.animation", "matplotlib.backends.backend_agg", "matplotlib.pyplot", "mpl_toolkits.mplot3d.art3d"),
}
IMPORT = b"import "
LATER = "libraries-later"


def main(
    control_fd: int,
    when: str = "",
    *,
    user: int | None,
    layers: list[str],
    readable: list[str],
    listable: list[str],
    folders: list[str],
) -> None:
    """Import the libraries and obey the control socket. With LATER as ``when``, leave out those in MODULES until one is needed."""
    control = socket.socket(fileno=control_fd)
    from .lockdown import Layers, die_with_parent, drop_privileges, identity

    die_with_parent()
    gc.disable()  # a collection of so many objects takes 20 ms
    for name in WARM:
        importlib.import_module(name)
    if when == LATER:
        importlib.import_module("guest.unused_libraries").install()
    else:
        for library in MODULES:
            _import(library)
    gc.collect()
    gc.freeze()
    sys.modules["guest.run_scenes"].copy_modules()
    prepared = Layers(layers, readable, listable, folders)  # before dropping privileges: only root may be able to open the paths
    drop_privileges(user)
    die_with_parent()  # again: the change of user has cleared it
    gc.collect()
    gc.freeze()
    gc.enable()
    control.send(READY + json.dumps(identity()).encode())
    _obey(control, prepared)


def _obey(control: socket.socket, prepared: Any) -> None:
    """Do what the control socket asks for, until the host closes it."""
    from .lockdown import identity

    while True:
        play, fds, _, _ = socket.recv_fds(control, 64, 4)
        if play.startswith(IMPORT):
            library = play.removeprefix(IMPORT).decode()
            sys.modules["guest.unused_libraries"].remove(library)
            _import(library)
            sys.modules["guest.run_scenes"].copy_modules()
            gc.collect()
            gc.freeze()
            control.send(READY)
            continue
        if not fds:
            return
        if len(fds) == 1:
            if middle := os.fork():
                os.waitpid(middle, 0)
                os.close(fds[0])
            elif os.fork():
                os._exit(0)  # so that the copy is not a child of this process, which would have to reap it
            else:
                control = socket.socket(fileno=fds[0])  # closes the other one in the copy
                control.send(READY + json.dumps(identity()).encode())
            continue
        (cpu_s,) = PLAY.unpack(play)
        job, result, output, *reference = fds
        places: dict[int, int | None] = {1: output, 2: output, 3: job, 4: result}
        children = []
        if reference:
            ends = [end.detach() for end in socket.socketpair()]
            fds += ends
            children.append(_fork("reference", prepared, {1: None, 2: None, 3: reference[0], 4: ends[0]}, cpu_s))
            places[5] = ends[1]
        children.insert(0, _fork("run_scenes", prepared, places, cpu_s))
        for fd in fds:
            os.close(fd)
        handles = [os.pidfd_open(child) for child in children]
        socket.send_fds(control, [b"child"], handles)
        control.send(_reap(children, handles))


def _import(library: str) -> None:
    for name in MODULES[library]:
        importlib.import_module(name)
    if library == "matplotlib":
        sys.modules["matplotlib"].use("Agg")


def _reap(children: list[int], handles: list[int]) -> bytes:
    """Wait until all children have exited: the others soon after the first. Close their handles."""
    statuses, cpu_s = list[int](), 0.0
    for child, handle in zip(children, handles, strict=True):
        if statuses and not select.select([handle], [], [], END_S)[0]:
            os.kill(child, signal.SIGKILL)
        _, status, used = os.wait4(child, 0)
        os.close(handle)
        statuses.append(status)
        cpu_s += used.ru_utime + used.ru_stime
    return REAPED.pack(*[*statuses, 0][:2], cpu_s)


def _fork(program: str, layers: Any, places: dict[int, int | None], cpu_s: int) -> int:
    """Start a child that runs a program of this package with descriptors at ``places``, from 3 on, None for /dev/null."""
    if child := os.fork():
        return child
    code = LOCKDOWN_FAILED
    try:
        devnull = os.open(os.devnull, os.O_RDWR)
        layers.apply({0: devnull} | {place: devnull if fd is None else fd for place, fd in places.items()}, cpu_s)
        run = importlib.import_module(f"guest.{program}").run

        code = 1
        run(*sorted(places)[2:])
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
