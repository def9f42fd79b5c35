"""The host's side of a zygote: start it, send it one job at a time, kill it when it misbehaves."""

import contextlib
import json
import logging
import math
import os
import shutil
import signal
import socket
import subprocess
import threading
import time
from collections.abc import Iterator
from io import FileIO
from pathlib import Path

from service.sandbox.guest.zygote import (
    IMPORT,
    IPYTHON,
    KINDS_MODULE,
    NEEDED,
    PLAY,
    READY,
    REAPED,
)
from service.sandbox.guest_frames import Reader
from service.sandbox.guest_process import GuestProcess
from service.sandbox.isolation.credentials import Identity
from service.sandbox.job import Job
from service.sandbox.result import KEPT_OUTPUT, Cancelled, OnScene, PlayResult, SystemFault, ignore
from service.sandbox.session import ChildExit, PlaySession
from service.sandbox.time_budget import ProcessorTimes, TimeBudget, processor_times
from service.sandbox.untrusted_text import text

log = logging.getLogger(__name__)
START_S, MOST_STARTS = 30.0, 20
ANSWER_S = 4.0  # a zygote that does not start or reap a child within this time is frozen


class ZygoteLost(Exception):
    """The zygote ended or froze during a play. The play may be tried again with another zygote."""


class LibraryNeeded(Exception):
    """The submission uses a ``library`` that the zygote has not imported. The play may be tried again when it
    has.
    """

    def __init__(self, library: str) -> None:
        super().__init__(library)
        self.library = library


class _Child:
    """A child that the zygote was asked to start, and the host's ends of its pipes: ``counted`` is that of
    another child, which holds the ``reference`` functions of a job, if it has some.
    """

    def __init__(self, reference: bytes | None) -> None:
        self.counted: FileIO | None = None
        (job, job_pipe), (answers, result), (printed, output) = os.pipe(), os.pipe(), os.pipe()
        self.theirs = [job, result, output]
        os.set_blocking(job_pipe, False)
        self.job_pipe, self.answers, self.printed = FileIO(job_pipe, "w"), FileIO(answers), FileIO(printed)
        if reference is not None:
            counted, counts = os.pipe()
            self.counted = FileIO(counted)
            self.theirs += [_file(reference), counts]

    def close(self) -> None:
        """Close the host's ends."""
        for end in (self.job_pipe, self.answers, self.printed, self.counted):
            if end is not None:
                end.close()


class Zygote:
    """A zygote in the process ``started``. Children can read its folder, which holds the job's data files
    during a play.

    Another thread may set ``cancelled`` to end a play. The zygote goes on.
    """

    def __init__(self, started: GuestProcess, cancelled: threading.Event) -> None:
        self._started, self._control = started, started.control
        self._cancelled = cancelled
        self.imported = started.imported
        self._identity: Identity | None = None  # known once it is ready

    def wait_ready(self) -> Identity:
        """Return the guest's identity when it has imported everything. Raises SystemFault with its output if
        it cannot start.
        """
        if self._identity is None:
            if not (message := self._message()).startswith(READY):
                self._started.log.seek(0)
                words = self._started.log.read(2000).decode(errors="replace").strip()
                self.kill()
                raise SystemFault(f"the sandbox did not start: {words or 'no output'}")
            self._identity = Identity(**json.loads(message[len(READY) :]))
        return self._identity

    @property
    def waited_s(self) -> float:
        """The seconds that the zygote and the children that it has now waited for a processor."""
        return _waited(self._started.process.pid)

    def import_library(self, library: str) -> None:
        """Let the zygote import ``library``. Raises ZygoteLost."""
        self._send(IMPORT + library.encode())
        if self._message() != READY:
            raise ZygoteLost("the sandbox process stopped between two plays")
        self.imported |= {library}

    def _message(self) -> bytes:
        """Return what the zygote sends after its imports, b"" if it ends or freezes. Waiting for a processor
        is not freezing.
        """
        self._control.settimeout(START_S)
        waited = 0.0
        for _ in range(MOST_STARTS):
            try:
                return self._control.recv(4096)
            except TimeoutError:
                before, waited = waited, _waited(self._started.process.pid)
                if waited - before < START_S / 2:
                    break
            except OSError:
                break
        return b""

    def play(self, job: Job, budget: TimeBudget, result: PlayResult, on_scene: OnScene = ignore) -> bool:
        """Play ``job`` in one child within ``budget`` and add to ``result``. Calls ``on_scene`` with the name
        of each that begins.

        Return False if the play ended abnormally and the zygote should be replaced. Raises Cancelled,
        LibraryNeeded, or ZygoteLost if the zygote does not answer: kill it, and try again with another.
        """
        self.wait_ready()
        with budget.charged():
            is_interactive = job.notebook  # of a Python file, this takes as long as parsing it
        if is_interactive and IPYTHON not in self.imported:
            self.import_library(IPYTHON)
        if KINDS_MODULE in job.plays and "kinds" not in self.imported:
            self.import_library("kinds")
        with (
            self._data_files(job) if job.data else contextlib.nullcontext(),
            contextlib.closing(self._start(job, budget)) as child,
        ):
            return self._run_child(child, job, budget, Reader(job, result, on_scene))

    def _send(self, message: bytes, *fds: int) -> None:
        try:
            socket.send_fds(self._control, [message], fds)
        except OSError as error:
            raise ZygoteLost(f"the sandbox process does not answer: {error}") from error

    def _start(self, job: Job, budget: TimeBudget) -> _Child:
        """Ask the zygote to start a child that can play ``job``."""
        child = _Child(job.encode_reference() if job.has_reference else None)
        try:
            limit = max(1, math.ceil(budget.cpu_left()))
            self._send(PLAY.pack(limit, job.memory_mb), *child.theirs)
        except ZygoteLost:
            child.close()
            raise
        finally:
            _close(*child.theirs)
        return child

    def _run_child(self, child: _Child, job: Job, budget: TimeBudget, reader: Reader) -> bool:
        """Play ``job`` in a child that ``_start`` has started."""
        pidfds = self._pidfds(2 if job.has_reference else 1)
        began, times = time.monotonic(), ProcessorTimes(*pidfds)
        session = PlaySession(
            job,
            budget,
            reader,
            self._control,
            child.job_pipe,
            child.answers,
            child.printed,
            child.counted,
            times,
            self._cancelled,
        )
        try:
            session.run()
            _kill(pidfds[0])
            session.ended = ended = session.ended or ChildExit.unpack(self._control.recv(REAPED.size))
        except OSError as error:
            raise ZygoteLost(f"the sandbox process was lost: {error}") from error
        finally:
            _kill(pidfds[0])  # no child of this job survives it
            _close(*pidfds)
            budget.charge(session.cpu_s, times.waited_s, time.monotonic() - began)
        reader.result.cpu_s = ended.cpu_s
        if needed := [n for n, code in NEEDED.items() if n not in self.imported and code in ended.codes]:
            raise LibraryNeeded(needed[0])
        if self._cancelled.is_set():
            raise Cancelled
        reader.result.stdout = text(session.output.decode(errors="replace"), KEPT_OUTPUT)
        session.record_end(reader.result)
        return not session.abnormal

    @contextlib.contextmanager
    def _data_files(self, job: Job) -> Iterator[None]:
        """Copy the job's data files into the folder in which children start, and remove them afterwards."""
        folder = self._started.data
        try:
            try:
                for name, source in job.data.items():
                    (folder / name).parent.mkdir(parents=True, exist_ok=True)
                    shutil.copyfile(source, folder / name)
                for path in folder.rglob("*"):  # whatever this process's umask is
                    path.chmod(0o755 if path.is_dir() else 0o644)
            except OSError as error:
                raise SystemFault(f"the data files of the assignment cannot be copied: {error}") from error
            yield
        finally:
            for path in folder.iterdir():
                shutil.rmtree(path) if path.is_dir() else path.unlink()

    def _pidfds(self, count: int) -> list[int]:
        """Return the pidfd of the child that was started, and with ``count`` 2 that of the one with its
        reference functions.
        """
        self._control.settimeout(ANSWER_S)
        try:
            word, pidfds, _, _ = socket.recv_fds(self._control, 16, 2)
        except OSError as error:
            raise ZygoteLost(f"the sandbox process does not answer: {error}") from error
        if word != b"child" or len(pidfds) != count:
            _close(*pidfds)
            raise ZygoteLost("the sandbox process stopped unexpectedly")
        return pidfds

    def kill(self) -> None:
        """Kill the zygote and its children, and wait until it has exited, for at most 10 s: what it has sent
        is valid in any case.
        """
        try:
            self._started.kill()
        except subprocess.TimeoutExpired:
            log.error("the sandbox process %d could not be killed", self._started.process.pid)


def _with_children(pid: int) -> list[int]:
    """Return the ids of a process and of all that it started and that still run."""
    try:
        children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    except OSError:
        return []
    return [pid, *(one for child in children for one in _with_children(int(child)))]


def _waited(pid: int) -> float:
    """Return the seconds that a process and all that it started waited for a processor."""
    return sum(processor_times(one)[1] for one in _with_children(pid))


def _file(content: bytes) -> int:
    """Return a descriptor of a file in memory, to read from its beginning."""
    fd = os.memfd_create("job")
    with open(fd, "wb", closefd=False) as file:
        file.write(content)
    os.lseek(fd, 0, os.SEEK_SET)
    return fd


def _kill(pidfd: int) -> None:
    with contextlib.suppress(ProcessLookupError):
        signal.pidfd_send_signal(pidfd, signal.SIGKILL)


def _close(*fds: int) -> None:
    for fd in fds:
        os.close(fd)
