"""The host's end of a warm guest: start it, hand it one job at a time, kill it when it misbehaves."""

import contextlib
import os
import signal
import socket
import subprocess
import tempfile
import threading
from collections.abc import Callable, Mapping, Sequence

from service.sandbox.guest.zygote import REAPED
from service.sandbox.job import Job
from service.sandbox.result import KEPT_OUTPUT, Cancelled, PlayResult, SystemFault
from service.sandbox.session import ExitStatus, Pipes, PlaySession
from service.sandbox.wire import Reader, text

START_S = 30.0
ANSWER_S = 4.0  # a zygote that does not start or bury a child within this time is frozen


class ZygoteLost(Exception):
    """The guest died or froze under a play that had nothing to do with it, or seemed to."""


class Zygote:
    """A guest process behind ``command``; the command gets the number of its control socket as last argument.

    ``unwanted`` may be set by another thread: it ends a play, not the guest.
    """

    def __init__(self, command: Sequence[str], environment: Mapping[str, str], unwanted: threading.Event) -> None:
        self._unwanted = unwanted
        self._control, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._log = tempfile.TemporaryFile()  # noqa: SIM115 -- it lives as long as the guest
        self._ready = False
        self._process = subprocess.Popen(
            [*command, str(theirs.fileno())],
            pass_fds=[theirs.fileno()],
            stdin=subprocess.DEVNULL,
            stdout=self._log,
            stderr=self._log,
            env=environment,
            start_new_session=True,
        )
        theirs.close()

    def wait_ready(self) -> None:
        """Return when it has imported everything; Fault with its own words if it cannot start."""
        if self._ready:
            return
        self._control.settimeout(START_S)
        with contextlib.suppress(OSError):
            self._ready = self._control.recv(5) == b"ready"
        if not self._ready:
            self._log.seek(0)
            words = self._log.read(2000).decode(errors="replace").strip()
            self.kill()
            raise SystemFault(f"the guest did not start: {words or 'it said nothing'}")

    def play(self, job: Job, seen: PlayResult, tell: Callable[[str], None] = lambda scene: None) -> bool:
        """Play the job once into ``seen`` and ``tell`` which scene begins.

        False when the play ended so oddly that this zygote should be replaced.

        Stopped when nobody wants it any more. ZygoteLost when the zygote does not answer: it must be killed, and the play may be
        tried again with another.
        """
        self.wait_ready()
        (job_r, job_w), (result_r, result_w), (output_r, output_w) = os.pipe(), os.pipe(), os.pipe()
        ours, theirs = (job_w, result_r, output_r), (job_r, result_w, output_w)
        try:
            try:
                child = self._fork(theirs)
            finally:
                _close(*theirs)
        except BaseException:
            _close(*ours)
            raise
        talk = PlaySession(job, Reader(job, seen, tell), Pipes(self._control, *ours), self._unwanted)
        try:
            talk.run()
        except OSError as error:
            raise ZygoteLost(f"the guest went away: {error}") from error
        finally:
            with contextlib.suppress(ProcessLookupError):
                signal.pidfd_send_signal(child, signal.SIGKILL)  # whatever happened, no child of this job is alive after it
            os.close(child)
        if talk.ended is None:
            talk.ended = self._wait_for_exit()
        if self._unwanted.is_set():
            raise Cancelled
        seen.stdout = text(talk.output.decode(errors="replace"), KEPT_OUTPUT)
        talk.record_end(seen)
        return not talk.odd

    def _fork(self, fds: tuple[int, int, int]) -> int:
        """A pidfd of the child that has got these descriptors."""
        self._control.settimeout(ANSWER_S)
        try:
            socket.send_fds(self._control, [b"play"], fds)
            word, handles, _, _ = socket.recv_fds(self._control, 16, 1)
        except OSError as error:
            raise ZygoteLost(f"the guest does not answer: {error}") from error
        if word != b"child" or len(handles) != 1:
            raise ZygoteLost("the guest ended")
        return handles[0]

    def _wait_for_exit(self) -> ExitStatus:
        """How the child ended, from a zygote that was told by its death."""
        try:
            return ExitStatus.unpack(self._control.recv(REAPED.size))
        except OSError as error:
            raise ZygoteLost(f"a child was killed and the guest does not say so: {error}") from error

    def kill(self) -> None:
        """End the guest and everything in it, and wait until it is gone."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._control.close()
        self._log.close()
        try:
            self._process.wait(timeout=10)
        except subprocess.TimeoutExpired as error:
            raise SystemFault("a guest could not be killed") from error


def _close(*fds: int) -> None:
    for fd in fds:
        os.close(fd)
