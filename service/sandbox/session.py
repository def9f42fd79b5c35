"""The host's side of one play: write the job, read results and output, and stop when a time or size limit is
exceeded.
"""

import os
import re
import selectors
import signal
import socket
import threading
import time
from collections import Counter
from dataclasses import dataclass, field
from io import FileIO
from pathlib import Path
from typing import Any, NamedTuple

from polhode.judging.outcome import Ended, SceneEnd
from service.sandbox.guest.cells.place import Place
from service.sandbox.guest.confinement.scratch import NO_ROOM
from service.sandbox.guest.wire import CLOCK_FACTOR, COUNT, MALFORMED
from service.sandbox.guest.zygote import REAPED
from service.sandbox.guest_frames import ProtocolError, Reader
from service.sandbox.job import MOST_LEFT_OUT, RUN_AGAIN, Job
from service.sandbox.result import CODES, KEPT_OUTPUT, SENTENCES, NotPrepared, PlayResult, SystemFault
from service.sandbox.time_budget import ProcessorTimes, TimeBudget
from service.sandbox.untrusted_text import text

GRACE_S = 1.5  # beyond a scene's budget, before the host ends a guest whose own alarm has not
LOAD_FACTOR = 2  # the host waits this many times as long as the guest has for loading
MOST_RESULT = 64 << 20
MOST_OUTPUT = 4 << 20
CHUNK = 1 << 16
OUT_OF_MEMORY = (
    "the kernel killed the process of the submission, because the machine or the container had no memory left"
)
POLL_S = 0.2  # interval at which a cancellation is noticed and the child's times are read


class ChildExit(NamedTuple):
    """The wait ``status`` of a child, that of the child with its ``reference`` functions, the seconds of CPU
    time of both, and whether the child ended because its scratch folder was ``full``.
    """

    status: int
    reference: int
    cpu_s: float
    full: bool

    @classmethod
    def unpack(cls, data: bytes) -> "ChildExit":
        """Read the zygote's message. Raises OSError if the zygote has ended."""
        if len(data) != REAPED.size:
            raise OSError("the sandbox process stopped unexpectedly")
        return cls(*REAPED.unpack(data))

    @property
    def codes(self) -> list[int]:
        """The exit codes of both, negative for a signal."""
        return [os.waitstatus_to_exitcode(status) for status in (self.status, self.reference)]

    def __str__(self) -> str:
        code = self.codes[0]
        how = f"ended by {signal.Signals(-code).name}" if code < 0 else f"exited with code {code}"
        return f"its process {how} after {self.cpu_s:.1f} s of CPU time"


@dataclass
class PlaySession:
    """One play of ``job`` within the ``budget`` of the grading.

    ``control`` is the zygote's socket, which reports the child's exit. The host's ends of the child's pipes,
    unbuffered, are ``job_pipe``, which does not block, ``answers``, which are frames, ``printed``, and with
    reference functions ``counted``: of each call the place of its function, which ``calls`` counts.
    ``stopped`` is the reason why the host ended the play, if it did. ``ended`` is the child's exit once it is
    known, and ``times`` those that the kernel reports of it. Another thread may set ``cancelled`` to end the
    play.
    """

    job: Job
    budget: TimeBudget
    reader: Reader
    control: socket.socket
    job_pipe: FileIO
    answers: FileIO
    printed: FileIO
    counted: FileIO | None
    times: ProcessorTimes
    cancelled: threading.Event = field(default_factory=threading.Event)
    output: bytearray = field(default_factory=bytearray)
    calls: Counter[int] = field(default_factory=Counter)
    stopped: Ended | None = None
    ended: ChildExit | None = None
    _received: int = 0
    _printed: int = 0
    _times_read: float = 0.0

    def run(self) -> None:
        """Exchange data until the child has exited and both pipes are empty, or a limit is exceeded.

        Raises OSError if the zygote has ended.
        """
        self._deadline = _Deadline(self.job)
        self._is_repeated = self.budget.running_s > 0
        self._killed_for_memory = kills_for_memory()
        self._unsent = memoryview(self.job.encode())
        with selectors.DefaultSelector() as self._selector:
            self._selector.register(self.job_pipe, selectors.EVENT_WRITE)
            for end in (self.answers, self.printed, self.control, self.counted):
                if end is not None:
                    self._selector.register(end, selectors.EVENT_READ)
            try:
                while self._is_running():
                    self._step()
            finally:
                self.times.update()

    def _is_running(self) -> bool:
        going_on = self.stopped is None and not self.cancelled.is_set()
        return going_on and bool(self._selector.get_map())

    def _step(self) -> None:
        """Wait until an end is ready, and read from it or write to it."""
        ready = self._selector.select(
            min(POLL_S, self._deadline.left(self.reader.started), self.budget.wall_left())
        )
        if (now := time.monotonic()) - self._times_read >= POLL_S:
            self._times_read = now
            self.times.update()
        if self.budget.wall_left() == 0 or (not ready and self._deadline.left(self.reader.started) == 0):
            self.stopped = Ended.TIMED_OUT
        for key, _ in ready:
            if key.fileobj is self.job_pipe:
                self._write_some()
            elif not self._read_from(key.fileobj):
                self._selector.unregister(key.fileobj)

    def _write_some(self) -> None:
        """Write what fits of the job, or nothing if the child has closed the pipe."""
        try:
            self._unsent = self._unsent[self.job_pipe.write(self._unsent[:CHUNK]) or 0 :]
        except BrokenPipeError:
            self._unsent = memoryview(b"")
        if not self._unsent:
            self._selector.unregister(self.job_pipe)
            self.job_pipe.close()

    def record_end(self, result: PlayResult) -> None:
        """Record the scene end that follows from the child's exit, for the scene in progress or else for all
        scenes that are left.

        Raises SystemFault if the child ended before it ran any code of the submission, or because the machine
        had no memory left.
        """
        scene_end = self.stopped or self._by_status()
        cut_short = scene_end is Ended.TIMED_OUT and self._is_repeated  # earlier children used up the time
        if not self.reader.prepared and not cut_short:
            if self.reader.not_prepared:
                raise NotPrepared(
                    f"its own code failed before the submission ran: {self.reader.not_prepared}"
                )
            words = text(self.output.decode(errors="replace")[-500:]) or str(self.ended)
            raise SystemFault(f"the sandbox failed before the submission ran: {words}")
        for name, calls in self.job.calls(self.calls).items():
            if "calls" in (arrays := result.arrays.get(name, {})):
                arrays["calls"] = calls  # what the submission's process says of them is worth nothing
        if scene_end is None:
            return
        was_killed = self.ended is not None and -signal.SIGKILL in self.ended.codes
        if was_killed and self.stopped is None and kills_for_memory() > self._killed_for_memory:
            raise SystemFault(OUT_OF_MEMORY)
        statement = self.reader.statement
        is_loading = statement is not None and not self.reader.loaded and scene_end is not Ended.PROTOCOL
        if statement and is_loading and len(self.job.left_out) < MOST_LEFT_OUT:
            self._leave_out(statement, scene_end, result)
            return
        if scene_end is Ended.PROTOCOL:  # discard everything that this child sent
            lost = [s.name for s in self.job.scenes]
            result.claims.clear()
            result.reported.clear()
        elif self.reader.started:
            lost = [self.reader.started]
        else:
            lost = [s.name for s in self.job.scenes if s.name not in result.scene_ends]
        sentence = self.budget.exceeded() if scene_end is Ended.TIMED_OUT else self._sentence(scene_end)
        for scene in lost:
            result.arrays.pop(scene, None)
            result.scene_ends[scene] = SceneEnd(
                scene=scene,
                ended=scene_end,
                sentence=sentence or SENTENCES[scene_end],
                code=CODES.get(scene_end),
            )

    def _leave_out(self, statement: Place, ended: Ended, result: PlayResult) -> None:
        """Record that a statement ended the child, so that the next one runs without it."""
        if self.reader.out_of_time:
            ended, sentence = Ended.TIMED_OUT, self.reader.out_of_time
        else:
            sentence = self._sentence(ended)
        cell_end = SceneEnd(
            scene=statement.cell,
            ended=ended,
            sentence=sentence + RUN_AGAIN,
            code=CODES.get(ended),
            traceback=self.job.frame(statement),
        )
        result.left_out[statement] = cell_end
        result.cells[statement.cell] = cell_end

    def _sentence(self, ended: Ended) -> str:
        return NO_ROOM if self.stopped is None and self.ended and self.ended.full else SENTENCES[ended]

    def _read_from(self, end: Any) -> bool:
        """Read from one end. Return False at its end of file."""
        if end is self.control:
            self.ended = ChildExit.unpack(end.recv(REAPED.size))
            return False
        data = end.read(CHUNK if end is not self.counted else CHUNK // COUNT.size * COUNT.size)
        if end is self.counted:
            for place, calls in COUNT.iter_unpack(data):
                self.calls[place] += calls
        elif end is self.printed:
            self._printed += len(data)
            self.output += data[: KEPT_OUTPUT - len(self.output)]
        else:
            self._received += len(data)
            try:
                self.reader.feed(data)
            except ProtocolError:
                self.stopped = Ended.PROTOCOL
        if self._printed > MOST_OUTPUT or self._received - self.reader.streamed > MOST_RESULT:
            self.stopped = Ended.OUTPUT
        return bool(data)

    @property
    def cpu_s(self) -> float:
        """The CPU time that the child used, as far as it is known."""
        return self.times.cpu_s if self.ended is None else self.ended.cpu_s

    @property
    def abnormal(self) -> bool:
        """Whether the child crashed or violated the protocol, which no ordinary mistake does."""
        return (self.stopped or self._by_status()) in (Ended.KILLED, Ended.PROTOCOL)

    def _by_status(self) -> Ended | None:
        assert self.ended is not None
        if self.ended.full:
            return Ended.OUTPUT
        code, reference = self.ended.codes
        if reference == MALFORMED:
            return Ended.PROTOCOL
        ended_by = -code  # a signal, if positive
        if ended_by == signal.SIGXCPU or (ended_by > 0 and not self.budget.cpu_left()):
            return Ended.TIMED_OUT
        if ended_by > 0:
            return Ended.KILLED
        return None if self.reader.done else Ended.EXITED


def kills_for_memory() -> int:
    """Return how many processes the kernel has killed for lack of memory since it started, in all containers;
    0 if it does not say.
    """
    try:
        found = re.search(r"^oom_kill (\d+)$", Path("/proc/vmstat").read_text(), re.MULTILINE)
    except OSError:
        return 0
    return int(found[1]) if found else 0


class _Deadline:
    """How long the host waits for a guest: the guest's wall-clock limits plus a grace period, and at most
    their sum.
    """

    def __init__(self, job: Job) -> None:
        self._budgets = {s.name: CLOCK_FACTOR * s.budget_s for s in job.scenes}
        self._load_s = LOAD_FACTOR * CLOCK_FACTOR * job.load_budget_s
        self._since = time.monotonic()
        self._last = (
            self._since + sum(self._budgets.values()) + GRACE_S * (1 + len(self._budgets)) + self._load_s
        )
        self._scene: str | None = None

    def left(self, scene: str | None) -> float:
        """Return the seconds left for ``scene`` (None: loading, or between scenes)."""
        if scene != self._scene:
            self._scene, self._since = scene, time.monotonic()
        until = self._since + GRACE_S + self._budgets.get(scene or "", self._load_s)
        return max(0.0, min(until, self._last) - time.monotonic())
