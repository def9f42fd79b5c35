"""The self-test: a submission that tries forbidden operations. A worker grades nothing until all of them have
failed.

In a defective sandbox the operations succeed on the server's machine, so none of them does harm.
"""

from service.sandbox.job import Cell, Job, SceneRequest

FORBIDDEN = {
    "read a file": "open('/etc/passwd').read()",
    "list the folders of others": "os.listdir('..')",
    "make a link": "os.symlink('/', 'link')",
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
    "trace a process": "trace()",
    "import the answers": "__import__('reference')",
    "take 1 GiB of memory": "bytearray(1 << 30)",
}
SOURCE = f"""
import ctypes, os, socket, threading

def trace():
    if ctypes.CDLL(None).ptrace(16, os.getppid() or 1, 0, 0) != 0:  # PTRACE_ATTACH
        raise OSError

for label, operation in {FORBIDDEN!r}.items():
    try:
        eval(operation)
    except (OSError, RuntimeError, MemoryError, ImportError):
        continue
    print(label)
"""


def self_test_job() -> Job:
    """Return a job that prints a line for each operation that succeeded. Its only scene calls a function that
    is not defined.
    """
    scene = SceneRequest("self-test", "nothing", "nothing", {}, {}, 5.0, None)
    return Job("", "", (Cell("self-test", SOURCE),), ("nothing",), (scene,))
