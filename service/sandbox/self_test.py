"""The probe: a submission that tries to get out. Nobody's work is taken until it has failed at everything.

Where the walls have a hole the attempts succeed, on the server's own machine: none of them does harm.
"""

from service.sandbox.job import Cell, Job, SceneRequest

ATTEMPTS = {
    "read a file": "open('/etc/passwd').read()",
    "write a file": "os.open('/', os.O_WRONLY | os.O_TMPFILE)",
    "write to a temporary folder": "os.open('/tmp', os.O_WRONLY | os.O_TMPFILE)",
    "start a process": "os._exit(0) if os.fork() == 0 else None",
    "start a thread": "threading.Thread(target=int).start()",
    "open a socket": "socket.socket()",
    "open a pair of sockets": "socket.socketpair()",
    "run a program": "os.posix_spawn('/bin/true', ['true'], {})",
    "signal its parent": "os.kill(os.getppid() or 1, 0)",
    "change a file's mode": "os.chmod('/dev/null', 0o666)",
    "make a file in memory": "os.memfd_create('x')",
    "trace a process": "traced()",
    "import the answers": "__import__('reference')",
    "take 1 GiB of memory": "bytearray(1 << 30)",
}
SOURCE = f"""
import ctypes, os, socket, threading

def traced():
    if ctypes.CDLL(None).ptrace(16, os.getppid() or 1, 0, 0) != 0:  # PTRACE_ATTACH
        raise OSError

for label, attempt in {ATTEMPTS!r}.items():
    try:
        eval(attempt)
    except (OSError, RuntimeError, MemoryError, ImportError):
        continue
    print(label)
"""


def probe() -> Job:
    """Prints a line for each attempt that worked; its only scene asks for a function that is not there."""
    scene = SceneRequest("probe", "nothing", "nothing", {}, {}, 5.0, None)
    return Job("", "", (Cell("probe", SOURCE),), ("nothing",), (scene,))
