"""A warm process that imports once and forks a fresh child for each job. It reads no submission and knows no secret."""

import importlib
import os
import signal
import socket
import sys
import traceback

LOCKDOWN_FAILED = 97
SCRATCH = "/polhode/scratch"
WARM = (
    "ecp.film",
    "guest.play",
    "guest.lockdown",
    "matplotlib.animation",
    "matplotlib.backends.backend_agg",
    "matplotlib.pyplot",
    "mpl_toolkits.mplot3d.art3d",
    "scipy.integrate",
)


def main(control_fd: int, walls: str) -> None:
    """Serve jobs from the control socket until the host closes it."""
    control = socket.socket(fileno=control_fd)
    _warm_up()
    control.sendall(b"ready")
    while True:
        _, fds, _, _ = socket.recv_fds(control, 1, 3)
        if len(fds) < 3:
            return
        child = os.fork()
        if child == 0:
            control.close()
            _child(walls, *fds)
        for fd in fds:
            os.close(fd)
        status = os.waitpid(child, 0)[1]
        code = 128 + os.WTERMSIG(status) if os.WIFSIGNALED(status) else os.WEXITSTATUS(status)
        control.sendall(bytes([code % 256]))


def _warm_up() -> None:
    for name in WARM:
        importlib.import_module(name)
    sys.modules["matplotlib"].use("Agg")


def _child(walls: str, job: int, result: int, output: int) -> None:
    code = LOCKDOWN_FAILED
    try:
        job, result, output = (_above_low(fd) for fd in (job, result, output))
        quiet = os.open(os.devnull, os.O_RDONLY)
        for fd, place in ((quiet, 0), (output, 1), (output, 2), (result, 3), (job, 4)):
            os.dup2(fd, place)
        os.closerange(5, 4096)
        from guest import lockdown, play

        if walls == "bubblewrap":
            lockdown.own_namespaces(SCRATCH)
            lockdown.give_up_privileges()
        else:
            lockdown.die_with_parent()
        lockdown.limit_resources(cpu_s=60, count_processes=walls == "bubblewrap")
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        code = 1
        play.run(4, 3)
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


def _above_low(fd: int) -> int:
    """The same open file under a number that the child's fixed places 0 to 4 do not overwrite."""
    import fcntl

    return fcntl.fcntl(fd, fcntl.F_DUPFD, 10)
