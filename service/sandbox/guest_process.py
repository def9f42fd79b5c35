"""The process of a zygote. This module imports no numpy, so that a guest starts before its host has imported
the rest.
"""

import contextlib
import os
import signal
import socket
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from service.sandbox.guest.zygote import LATER, MODULES


class GuestProcess:
    """A zygote's ``process``, started by ``command``, which gets the number of its end of ``control`` as last
    argument.

    It starts in the folder ``data`` of its own and writes to the file ``log``. Without ``libraries`` it
    starts sooner and imports one of MODULES when a job needs it.
    """

    def __init__(
        self, command: Sequence[str], environment: Mapping[str, str], *, libraries: bool = True
    ) -> None:
        self.imported = frozenset(MODULES if libraries else ())
        self.data = tempfile.TemporaryDirectory(prefix="polhode-data-")
        os.chmod(self.data.name, 0o755)  # noqa: S103 -- the guest may be another user
        self.control, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.log = tempfile.TemporaryFile()  # noqa: SIM115 -- lives as long as the zygote
        self.process = subprocess.Popen(
            [*command, str(theirs.fileno()), *([] if libraries else [LATER])],
            pass_fds=[theirs.fileno()],
            stdin=subprocess.DEVNULL,
            stdout=self.log,
            stderr=self.log,
            env=environment,
            cwd=self.data.name,
            start_new_session=True,
        )
        theirs.close()
        with contextlib.suppress(
            OSError
        ):  # Linux may schedule each session as a group (sched_autogroup) whose niceness counts
            Path(f"/proc/{self.process.pid}/autogroup").write_text(str(os.getpriority(os.PRIO_PROCESS, 0)))

    def kill(self) -> None:
        """Kill the zygote with its children, and wait until it has exited. Raises TimeoutExpired if it has
        not after 10 s.
        """
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)
        self.control.close()
        self.log.close()
        self.data.cleanup()
        self.process.wait(timeout=10)
