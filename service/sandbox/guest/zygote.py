"""The zygote: a warm process that imports the libraries once and forks a child for each play.

It reads no submission and has no secret. Each child that runs a submission has a scratch folder
(scratch.py). If one cannot be removed, the zygote ends.

For each play the host sends three descriptors (job, result, output) and PLAY. The zygote returns a pidfd,
with which the host can kill the child, and after the child's exit its wait status and the CPU time that it
used. With two more descriptors, a job of reference functions and a pipe for their calls, a second child holds
these and answers calls of the first one (cross_process_calls.py): it gets the same layers and limits, its
pidfd and wait status are returned too, and it does not survive the first. The zygote's first message is READY
and its identity as JSON. A zygote that imports a library of MODULES later does so when it receives IMPORT and
the name of one, and answers READY.
"""

import contextlib
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
from collections.abc import Mapping
from typing import Any, NoReturn

from .confinement.scratch import FULL, WATCH_S, Scratch

NEEDED = {
    "scipy": 95,
    "matplotlib": 96,
}  # exit codes of a child that uses a library which the zygote has not imported
LOCKDOWN_FAILED = 97  # exit code
READY = b"ready"
PLAY = struct.Struct("<ii")  # limits of CPU time in seconds and of memory in MiB
REAPED = struct.Struct("<iid?")
"""Wait status, that of the child with the reference functions or 0, CPU time of both in seconds, and whether
the child ended because its scratch folder was full.
"""
END_S = 0.5  # for the child with the reference functions to read what is left and to exit
WARM = (
    "polhode.animation.animation_recording",
    "guest.confinement.lockdown",
    "guest.reference_process",
    "guest.run_scenes",
    "hashlib",
)
KINDS_MODULE = "polhode.kinds"
IPYTHON = "ipython"
MODULES = {
    "kinds": (KINDS_MODULE,),
    "scipy": ("scipy.integrate", "scipy.linalg", "scipy.optimize", "scipy.spatial.transform"),
    "matplotlib": (
        "matplotlib.animation",
        "matplotlib.backends.backend_agg",
        "matplotlib.pyplot",
        "mpl_toolkits.mplot3d.art3d",
    ),
    IPYTHON: ("guest.cells.shell",),
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
    scratch: str,
    course: list[str],
    libraries: list[str],
) -> None:
    """Import the libraries and obey the control socket. With LATER as ``when``, leave out those in MODULES
    until one is needed.

    ``course`` are the folders with the course's own packages, which import ``libraries``. The scratch folders
    of children are made in the folder ``scratch``.
    """
    control = socket.socket(fileno=control_fd)
    from .confinement.lockdown import Layers, die_with_parent, drop_privileges, identity

    die_with_parent()
    gc.disable()  # a collection of so many objects takes 20 ms and finds little
    for name in WARM:
        importlib.import_module(name)
    sys.modules["guest.cells.claim_recorder"].course[:] = course
    if when == LATER:
        importlib.import_module("guest.deferred_libraries").install()
    else:
        for library in MODULES:
            _import(library)
        for library in libraries:
            with contextlib.suppress(Exception):  # what fails here fails in the child too, and is named there
                importlib.import_module(library)
    importlib.import_module("guest.confinement.readable_modules").install()
    gc.freeze()
    sys.modules["guest.run_scenes"].copy_modules()
    prepared = Layers(
        layers, readable, listable, folders
    )  # before dropping privileges: only root may be able to open the paths
    scratch = os.path.abspath(scratch)
    if user is not None:
        with contextlib.suppress(PermissionError):  # in namespaces all may write to it
            os.chown(scratch, user, user)
    drop_privileges(user)
    die_with_parent()  # again: the change of user has cleared it
    gc.collect()
    gc.freeze()
    gc.enable()
    control.send(READY + json.dumps(identity()).encode())
    _obey(control, prepared, scratch)


def _obey(control: socket.socket, layers: Any, room: str) -> None:
    """Do what the control socket asks for, until the host closes it."""
    while True:
        message, fds, _, _ = socket.recv_fds(control, 256, 5)
        if message.startswith(IMPORT):
            _import_later(message.removeprefix(IMPORT).decode())
            control.send(READY)
        elif fds:
            _run_children(control, layers, room, PLAY.unpack(message), fds)
        else:
            return


def _run_children(
    control: socket.socket, layers: Any, room: str, limits: tuple[int, ...], fds: list[int]
) -> None:
    """Start the children of a play with descriptors of job, result, output, and of the reference functions if
    there are more. Report their pidfds and how they ended, and remove the scratch folder.
    """
    scratch, calls = Scratch(room), list[int]()
    scratch.fill(os.curdir)
    reference = fds[3:]
    if reference:
        calls = [end.detach() for end in socket.socketpair()]
    children = [_fork_submission(layers, scratch, [*fds[:3], *calls[1:]], limits)]
    if reference:
        children.append(_fork_reference(layers, [reference[0], calls[0], reference[1]], limits))
    for fd in (*fds, *calls):
        os.close(fd)
    handles = [os.pidfd_open(child) for child in children]
    socket.send_fds(control, [b"child"], handles)
    control.send(_reap(children, handles, scratch))
    scratch.remove()


def _import_later(library: str) -> None:
    """Import a library that was left out at the start."""
    sys.modules["guest.deferred_libraries"].remove(library)
    _import(library)
    sys.modules["guest.run_scenes"].copy_modules()
    gc.collect()
    gc.freeze()


def _import(library: str) -> None:
    for name in MODULES[library]:
        importlib.import_module(name)
    if library == "matplotlib":
        importlib.import_module("guest.headless_matplotlib").install()
    if library == IPYTHON:
        sys.modules["guest.cells.shell"].warm_up()


def _reap(children: list[int], handles: list[int], scratch: Scratch) -> bytes:
    """Wait until all children have exited: the others soon after the first, whose folder is ``scratch``.
    Close their handles.
    """
    statuses, cpu_s = list[int](), 0.0
    full = _watch(children[0], handles[0], scratch)
    for child, handle in zip(children, handles, strict=True):
        if statuses and not select.select([handle], [], [], END_S)[0]:
            os.kill(child, signal.SIGKILL)
        _, status, used = os.wait4(child, 0)
        os.close(handle)
        statuses.append(status)
        cpu_s += used.ru_utime + used.ru_stime
    full = full or os.waitstatus_to_exitcode(statuses[0]) == FULL
    return REAPED.pack(*[*statuses, 0][:2], cpu_s, full)


def _watch(child: int, handle: int, scratch: Scratch) -> bool:
    """Wait until a child exits, and kill it if its scratch folder is full. Return whether it was.

    Raises OSError if the disk is nearly full, which may not be the child's fault.
    """
    while not select.select([handle], [], [], WATCH_S)[0]:
        if scratch.is_full():
            os.kill(child, signal.SIGKILL)
            return True
        if scratch.fills_the_disk():
            raise OSError("the disk with the scratch folders is nearly full")
    return False


def _fork_submission(layers: Any, scratch: Scratch, fds: list[int], limits: tuple[int, ...]) -> int:
    """Start the child that runs a submission, and return its process id."""
    zygote = os.getpid()
    if child := os.fork():
        return child
    try:
        sys.modules["guest.confinement.lockdown"].die_with_parent(zygote)
        scratch.enter()
        layers.own_folder(scratch.path)
    except BaseException:
        traceback.print_exc()
        os._exit(LOCKDOWN_FAILED)
    job, result, output, *calls = fds
    places = {1: output, 2: output, 3: job, 4: result} | dict(enumerate(calls, start=5))
    _run("run_scenes", layers, places, limits)


def _fork_reference(layers: Any, fds: list[int], limits: tuple[int, ...]) -> int:
    """Start the child that holds reference functions, and return its process id."""
    if child := os.fork():
        return child
    layers.own_folder(None)
    _run("reference_process", layers, {1: None, 2: None} | dict(enumerate(fds, start=3)), limits)


def _run(program: str, layers: Any, places: Mapping[int, int | None], limits: tuple[int, ...]) -> NoReturn:
    """Run a program of this package with descriptors at ``places``, from 3 on, None for /dev/null.
    Exit then.
    """
    code = LOCKDOWN_FAILED
    try:
        devnull = os.open(os.devnull, os.O_RDWR)
        layers.apply(
            {0: devnull} | {place: devnull if fd is None else fd for place, fd in places.items()}, *limits
        )
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
        os.closerange(
            1, max(places) + 1
        )  # so that the host has everything before the kernel has released the memory
        os._exit(code)
