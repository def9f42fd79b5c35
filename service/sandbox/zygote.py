"""The host's end of a warm guest: start it, hand it one job at a time, kill it when it misbehaves."""

import contextlib
import os
import signal
import socket
import subprocess
import tempfile
from collections.abc import Mapping, Sequence

from service.sandbox.conversation import KEPT_OUTPUT, Conversation, Pipes
from service.sandbox.job import Job
from service.sandbox.seen import Fault, Seen
from service.sandbox.wire import Reader, text

START_S = 30.0


class Zygote:
    """A guest process behind ``command``; the command gets the number of its control socket as last argument."""

    def __init__(self, command: Sequence[str], environment: Mapping[str, str]) -> None:
        self._control, theirs = socket.socketpair()
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
        self._control.settimeout(None)
        if not self._ready:
            self._log.seek(0)
            words = self._log.read(2000).decode(errors="replace").strip()
            self.kill()
            raise Fault(f"the guest did not start: {words or 'it said nothing'}")

    def play(self, job: Job, seen: Seen) -> bool:
        """Play the job once into ``seen``; False when this zygote had to be killed and another is needed."""
        self.wait_ready()
        (job_r, job_w), (result_r, result_w), (output_r, output_w) = os.pipe(), os.pipe(), os.pipe()
        talk = Conversation(job, Reader(job, seen), Pipes(self._control, job_w, result_r, output_r))
        try:
            try:
                socket.send_fds(self._control, [b"j"], [job_r, result_w, output_w])
            finally:
                for fd in (job_r, result_w, output_w):
                    os.close(fd)
            talk.hold()
        except OSError as error:
            self.kill()
            raise Fault(f"the guest went away: {error}") from error
        except BaseException:
            self.kill()  # whatever went wrong, no child of this job may be alive when the next one comes
            raise
        if talk.stopped is not None:
            self.kill()
        seen.stdout = (seen.stdout + text(talk.output.decode(errors="replace"), KEPT_OUTPUT))[:KEPT_OUTPUT]
        talk.conclude(seen)
        return talk.stopped is None

    def kill(self) -> None:
        """End the guest and everything in it, and wait until it is gone."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._control.close()
        self._log.close()
        try:
            self._process.wait(timeout=10)
        except subprocess.TimeoutExpired as error:
            raise Fault("a guest could not be killed") from error
