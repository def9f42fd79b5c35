"""One play as the host sees it: write the job, read results and output, and stop listening when patience or room runs out."""

import contextlib
import math
import os
import selectors
import signal
import socket
import threading
import time
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ecp.outcome import Ended, SceneEnd
from service.sandbox.guest.run_scenes import CLOCK_FACTOR
from service.sandbox.guest.wire import QUESTION
from service.sandbox.guest.zygote import REAPED
from service.sandbox.job import Job
from service.sandbox.result import KEPT_OUTPUT, SENTENCES, PlayResult, SystemFault
from service.sandbox.wire import ProtocolError, Reader, text

GRACE_S = 1.5  # on top of a scene's budget, before the host stops trusting the guest's own alarm
LOADING = 2  # the host waits for twice the time that the guest has for loading
MOST_RESULT = 64 << 20
MOST_OUTPUT = 4 << 20
CHUNK = 1 << 16
LOOK_S = 0.2  # so often it is seen whether the play is wanted any more
CODES = {Ended.TIMED_OUT: "timeout", Ended.MEMORY: "memory"}


@dataclass
class Pipes:
    """The host's ends: the job goes out, results and printed output come in, ``control`` tells when the child was reaped."""

    control: socket.socket
    job: int
    result: int
    output: int


class ExitStatus(NamedTuple):
    """How the child ended: a wait status."""

    status: int

    @classmethod
    def unpack(cls, data: bytes) -> "ExitStatus":
        """From the zygote's message; OSError if it is none: the zygote is gone."""
        if len(data) != REAPED.size:
            raise OSError("the guest ended")
        return cls(*REAPED.unpack(data))

    @property
    def signal(self) -> int:
        """The signal that ended it, or 0."""
        return os.WTERMSIG(self.status) if os.WIFSIGNALED(self.status) else 0


class NoAnswer(Exception):
    """A question the child will not answer any more: the scene has ended."""


@dataclass
class PlaySession:
    """``stopped`` says why the host ended it, if it did; ``ended`` how the child did, once it is known.

    Another thread may set ``unwanted``: then it ends at once.
    """

    job: Job
    reader: Reader
    pipes: Pipes
    unwanted: threading.Event = field(default_factory=threading.Event)
    output: bytearray = field(default_factory=bytearray)
    stopped: Ended | None = None
    ended: ExitStatus | None = None
    _received: int = 0
    _printed: int = 0
    _job_open: bool = True

    def run(self) -> None:
        """Talk until the child is reaped and both pipes are empty, or patience ends; closes the pipes. OSError: no guest."""
        self._unsent = memoryview(self.job.encode())
        self._undriven = {s.name: s.drive for s in self.job.scenes if s.drive}
        self._patience = _Deadline(self.job)
        os.set_blocking(self.pipes.job, False)
        with selectors.DefaultSelector() as self._selector:
            self._selector.register(self.pipes.job, selectors.EVENT_WRITE)
            for end in (self.pipes.result, self.pipes.output, self.pipes.control):
                self._selector.register(end, selectors.EVENT_READ)
            try:
                while self._goes_on():
                    self._step()
                    if self.reader.started in self._undriven:
                        self._drive(self.reader.started)
            finally:
                for fd in (self.pipes.result, self.pipes.output):
                    if fd in self._selector.get_map():
                        os.close(fd)
                if self._job_open:
                    os.close(self.pipes.job)

    def _goes_on(self) -> bool:
        return self.stopped is None and not self.unwanted.is_set() and bool(self._selector.get_map())

    def _step(self) -> None:
        """Wait for the next that is ready, and take it."""
        ready = self._selector.select(min(LOOK_S, self._patience.left(self.reader.started)))
        if not ready and self._patience.left(self.reader.started) == 0:
            self.stopped = Ended.TIMED_OUT
        for key, _ in ready:
            if key.fd == self.pipes.job:
                self._unsent = _write_some(key.fd, self._unsent)
                if not self._unsent:
                    self._selector.unregister(key.fd)
                    self._close_job_unless_needed()
            elif not self._listen(key.fd):
                self._selector.unregister(key.fileobj)
                if key.fd != self.pipes.control.fileno():
                    os.close(key.fd)

    def _drive(self, scene: str) -> None:
        """Let the scene's driver ask; what it returns is kept, unless the scene ends before it does."""
        driver = self._undriven.pop(scene)
        with contextlib.suppress(NoAnswer):
            self.reader.seen.driven[scene] = driver(self._ask)
            self._send(QUESTION.pack(*[math.nan] * 7))
        self._close_job_unless_needed()

    def _ask(self, t: float, w: NDArray[np.float64], I: NDArray[np.float64]) -> NDArray[np.float64]:
        scene = self.reader.started
        self.reader.open_questions += 1
        self._send(QUESTION.pack(t, *w, *I))
        while not self.reader.answers:
            if not self._goes_on() or self.reader.started != scene:
                raise NoAnswer
            self._step()
        return self.reader.answers.popleft()

    def _send(self, data: bytes) -> None:
        try:
            sent = os.write(self.pipes.job, data)
        except BrokenPipeError:
            raise NoAnswer from None
        except BlockingIOError:
            sent = 0
        if sent != len(data):  # it answers without reading the questions
            self.stopped = Ended.PROTOCOL
            raise NoAnswer

    def _close_job_unless_needed(self) -> None:
        if self._job_open and not self._undriven:
            os.close(self.pipes.job)
            self._job_open = False

    def record_end(self, seen: PlayResult) -> None:
        """Give the scene in progress the ending that follows from how the child stopped; between scenes, all that are left."""
        assert self.ended is not None
        if not self.reader.inside:  # nothing of the submission had run yet
            words = text(self.output.decode(errors="replace")[-500:])
            raise SystemFault(
                f"a child ended before it read the submission, its walls or our own code failed: {words or self.ended}"
            )
        scene_end = self.stopped or self._by_status()
        if scene_end is None:
            return
        if scene_end is Ended.PROTOCOL:  # nothing that this child sent is believed
            lost = [s.name for s in self.job.scenes]
            seen.claims.clear()
        elif self.reader.started:
            lost = [self.reader.started]
        else:
            lost = [s.name for s in self.job.scenes if s.name not in seen.scene_ends]
        for scene in lost:
            seen.arrays.pop(scene, None)
            seen.scene_ends[scene] = SceneEnd(
                scene=scene, ended=scene_end, sentence=SENTENCES[scene_end], code=CODES.get(scene_end)
            )

    def _listen(self, fd: int) -> bool:
        """Take what one end has to say; False when it has said its last."""
        if fd == self.pipes.control.fileno():
            self.ended = ExitStatus.unpack(self.pipes.control.recv(REAPED.size))
            return False
        data = os.read(fd, CHUNK)
        if fd == self.pipes.output:
            self._printed += len(data)
            self.output += data[: KEPT_OUTPUT - len(self.output)]
        else:
            self._received += len(data)
            try:
                self.reader.feed(data)
            except ProtocolError:
                self.stopped = Ended.PROTOCOL
        if self._printed > MOST_OUTPUT or self._received > MOST_RESULT:
            self.stopped = Ended.OUTPUT
        return bool(data)

    @property
    def odd(self) -> bool:
        """Whether it ended in a way no ordinary mistake does."""
        crashed = self.stopped is None and self.ended is not None and self.ended.signal not in (0, signal.SIGXCPU)
        return crashed or self.stopped is Ended.PROTOCOL

    def _by_status(self) -> Ended | None:
        assert self.ended is not None
        if self.ended.signal == signal.SIGXCPU:
            return Ended.TIMED_OUT
        if self.ended.signal:
            return Ended.KILLED
        return None if self.reader.done else Ended.EXITED


class _Deadline:
    """How long to wait for the next word: as long as the guest's own limits by the clock, and never past the sum of them all."""

    def __init__(self, job: Job) -> None:
        self._budgets = {s.name: CLOCK_FACTOR * s.budget_s for s in job.scenes}
        self._load_s = LOADING * CLOCK_FACTOR * job.load_budget_s
        self._since = time.monotonic()
        self._last = self._since + sum(self._budgets.values()) + GRACE_S * (1 + len(self._budgets)) + self._load_s
        self._scene: str | None = None

    def left(self, scene: str | None) -> float:
        """Seconds left for ``scene`` (None: loading, or between scenes)."""
        if scene != self._scene:
            self._scene, self._since = scene, time.monotonic()
        until = self._since + GRACE_S + self._budgets.get(scene or "", self._load_s)
        return max(0.0, min(until, self._last) - time.monotonic())


def _write_some(fd: int, data: memoryview) -> memoryview:
    """What is left to write; nothing, if nobody reads any more."""
    try:
        return data[os.write(fd, data[:CHUNK]) :]
    except BrokenPipeError:
        return memoryview(b"")
