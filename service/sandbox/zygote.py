"""The host's end of a warm guest: start it, hand it one job at a time, read what comes back, kill it when it misbehaves."""

import os
import selectors
import signal
import socket
import subprocess
import tempfile
import time
from dataclasses import dataclass, field

from service.sandbox.job import LOAD_BUDGET_S, Job
from service.sandbox.seen import SENTENCES, Ending, Fault, SceneEnding, Seen
from service.sandbox.wire import ProtocolError, Reader, text

START_S = 30.0
GRACE_S = 1.5  # on top of a scene's budget, before the host stops trusting the guest's own alarm
MOST_RESULT = 64 << 20
MOST_OUTPUT, KEPT_OUTPUT = 4 << 20, 64 << 10
LOCKDOWN_FAILED = 97


class Zygote:
    """A guest process behind ``command``; the command gets the number of its control socket as last argument."""

    def __init__(self, command: list[str], environment: dict[str, str]) -> None:
        self._control, theirs = socket.socketpair()
        self._log = tempfile.TemporaryFile()
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
        try:
            self._ready = self._control.recv(5) == b"ready"
        except OSError:
            pass
        if not self._ready:
            self.kill()
            self._log.seek(0)
            raise Fault(f"the guest did not start: {self._log.read(2000).decode(errors='replace').strip() or 'no word'}")

    def play(self, job: Job, seen: Seen) -> bool:
        """Play the job once into ``seen``; False when this zygote had to be killed and another is needed."""
        self.wait_ready()
        run = _Run(job, Reader(job, seen))
        job_r, job_w = os.pipe()
        result_r, result_w = os.pipe()
        output_r, output_w = os.pipe()
        try:
            socket.send_fds(self._control, [b"j"], [job_r, result_w, output_w])
            for fd in (job_r, result_w, output_w):
                os.close(fd)
            run.converse(self._control, job_w, result_r, output_r)
        except OSError as error:
            self.kill()
            raise Fault(f"the guest went away: {error}") from error
        if run.stopped is not None:
            self.kill()
        seen.stdout = (seen.stdout + text(run.output.decode(errors="replace"), KEPT_OUTPUT))[:KEPT_OUTPUT]
        run.conclude(seen)
        return run.stopped is None

    def kill(self) -> None:
        """End the guest and everything in it, and wait until it is gone."""
        try:
            os.killpg(self._process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        self._process.wait(timeout=10)
        self._control.close()


@dataclass
class _Run:
    """One conversation: what was said, when patience ends, and why it was stopped if it was."""

    job: Job
    reader: Reader
    output: bytearray = field(default_factory=bytearray)
    stopped: Ending | None = None
    code: int | None = None

    def converse(self, control: socket.socket, job_w: int, result_r: int, output_r: int) -> None:
        """Write the job, read results and output until the child is reaped and both pipes are empty, or patience ends."""
        control.settimeout(None)
        question = memoryview(self.job.encode())
        received = printed = 0
        started, progress = None, time.monotonic()
        last = progress + sum(s.budget_s + GRACE_S for s in self.job.scenes) + LOAD_BUDGET_S * 2 + GRACE_S
        os.set_blocking(job_w, False)
        open_fds = {result_r, output_r, job_w}
        with selectors.DefaultSelector() as selector:
            selector.register(job_w, selectors.EVENT_WRITE)
            for fd in (result_r, output_r, control.fileno()):
                selector.register(fd, selectors.EVENT_READ)
            try:
                while open_fds & {result_r, output_r} or self.code is None:
                    if self.reader.started != started:
                        started, progress = self.reader.started, time.monotonic()
                    patience = min(progress + self._budget(started) + GRACE_S, last) - time.monotonic()
                    ready = selector.select(max(0.0, patience)) if patience > 0 else []
                    if not ready:
                        self.stopped = Ending.TIMED_OUT
                        return
                    for key, _ in ready:
                        if key.fd == job_w:
                            question = _write_some(job_w, question)
                            if not question:
                                _close(selector, job_w, open_fds)
                        elif key.fd == control.fileno():
                            self.code = (control.recv(1) or bytes([LOCKDOWN_FAILED]))[0]
                            selector.unregister(control)
                        else:
                            data = os.read(key.fd, 1 << 16)
                            if not data:
                                _close(selector, key.fd, open_fds)
                            elif key.fd == result_r:
                                received += len(data)
                                self.reader.feed(data)
                            else:
                                printed += len(data)
                                self.output += data[: KEPT_OUTPUT - len(self.output)]
                            if received > MOST_RESULT or printed > MOST_OUTPUT:
                                self.stopped = Ending.OUTPUT
                                return
            except ProtocolError:
                self.stopped = Ending.PROTOCOL
            finally:
                for fd in list(open_fds):
                    os.close(fd)

    def conclude(self, seen: Seen) -> None:
        """Give every scene that has no ending the one that follows from how the child stopped."""
        if self.code == LOCKDOWN_FAILED:
            raise Fault(f"the walls around a submission could not be put up: {self.output.decode(errors='replace')[-500:]}")
        ending = self.stopped or self._by_exit_code()
        if ending is None and not self.reader.done:
            ending = Ending.EXITED
        if ending is None:
            return
        scene = self.reader.started or next((s.name for s in self.job.scenes if s.name not in seen.endings), None)
        if scene is not None:
            seen.arrays.pop(scene, None)
            seen.endings[scene] = SceneEnding(scene=scene, ending=ending, sentence=SENTENCES[ending], code=_CODES.get(ending))

    def _budget(self, started: str | None) -> float:
        return next((s.budget_s for s in self.job.scenes if s.name == started), LOAD_BUDGET_S * 2)

    def _by_exit_code(self) -> Ending | None:
        if self.code is None or self.code < 128:
            return None
        return Ending.TIMED_OUT if self.code - 128 == signal.SIGXCPU else Ending.KILLED


_CODES = {Ending.TIMED_OUT: "timeout", Ending.MEMORY: "memory"}


def _write_some(fd: int, data: memoryview) -> memoryview:
    """What is left to write; nothing, if nobody reads any more."""
    try:
        return data[os.write(fd, data[: 1 << 16]) :]
    except BrokenPipeError:
        return memoryview(b"")


def _close(selector: selectors.BaseSelector, fd: int, open_fds: set[int]) -> None:
    selector.unregister(fd)
    open_fds.discard(fd)
    os.close(fd)
