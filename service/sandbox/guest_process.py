"""The process of a zygote, with a folder of its own, which is removed with it."""

import contextlib
import fcntl
import logging
import os
import signal
import socket
import subprocess
import tempfile
import time
import weakref
from collections.abc import Mapping, Sequence
from pathlib import Path

from service.sandbox.guest.confinement import scratch
from service.sandbox.guest.zygote import LATER, MODULES

log = logging.getLogger(__name__)
COMMON = Path("/tmp")
PREFIX = "polhode-sandbox-"  # of the folders of guests; each is locked by its host while that lives
NEW_S = 60.0  # a younger folder may not be locked yet
TRIES, PAUSE_S = 40, 0.05


class GuestProcess:
    """A zygote's ``process``, started by ``command``, which gets the number of its end of ``control`` as last
    argument.

    It starts in the folder ``data`` of its own and writes to the file ``log``. Beside that folder is one in
    which, without namespaces, it makes the scratch folders of its children. Without ``libraries`` it starts
    sooner and imports one of MODULES when a job needs it.
    """

    def __init__(
        self, command: Sequence[str], environment: Mapping[str, str], *, libraries: bool = True
    ) -> None:
        self.imported = frozenset(MODULES if libraries else ())
        folder = Path(tempfile.mkdtemp(prefix=PREFIX, dir=_temporary_folder()))
        self._remove_folder = weakref.finalize(self, _remove, folder, _locked(folder))
        self.data = folder / "data"
        self.data.mkdir()
        (folder / "scratch").mkdir(0o700)
        for shown, mode in ((folder, 0o711), (self.data, 0o755)):  # the guest may be another user
            shown.chmod(mode)
        self.control, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.log = tempfile.TemporaryFile()  # noqa: SIM115 -- lives as long as the zygote
        self.process = subprocess.Popen(
            [*command, str(theirs.fileno()), *([] if libraries else [LATER])],
            pass_fds=[theirs.fileno()],
            stdin=subprocess.DEVNULL,
            stdout=self.log,
            stderr=self.log,
            env=environment,
            cwd=self.data,
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
        self.process.wait(timeout=10)
        self._remove_folder()


def _temporary_folder() -> Path:
    """Return the folder for temporary files, or if root has one that is closed to others, a common one."""
    found = Path(tempfile.gettempdir()).absolute()
    is_open = all(folder.stat().st_mode & 0o001 for folder in (found, *found.parents))
    return found if is_open or os.geteuid() != 0 else COMMON


def remove_abandoned() -> None:
    """Remove the folders of guests whose hosts were killed before they could."""
    for folder in _temporary_folder().glob(f"{PREFIX}*"):
        with contextlib.suppress(OSError):  # locked, another user's, or gone
            lock = _locked(folder)
            found = os.fstat(lock)
            if found.st_uid == os.geteuid() and time.time() - found.st_mtime > NEW_S:
                _remove(folder, lock)
            else:
                os.close(lock)


def _locked(folder: Path) -> int:
    """Lock a folder until the descriptor that is returned is closed. Raises OSError if another has locked
    it.
    """
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(descriptor)
        raise
    return descriptor


def _remove(folder: Path, lock: int) -> None:
    """Remove the folder of a guest that has been killed, and close its ``lock``."""
    try:
        _remove_contents(folder)
    finally:
        os.close(lock)


def _remove_contents(folder: Path) -> None:
    """Remove the folder with its contents. Children may need a moment to end."""
    for _ in range(TRIES):
        try:
            for one in folder.iterdir():
                scratch.remove(str(one))
            folder.rmdir()
        except FileNotFoundError:
            return
        except OSError as error:
            reason = error
            time.sleep(PAUSE_S)
        else:
            return
    log.error("the folder %s of a sandbox process could not be removed: %s", folder, reason)
