"""Chaos: submissions come in while server, workers and database are killed, frozen and cut off at random;
then it is counted.

``make chaos KILLS=N SEED=S`` runs it for long, a test for short. Everything is real: ``polhode serve`` with
its embedded database and two workers, another machine with two workers, submissions over HTTP from three
clients that repeat themselves as a student's notebook would. What must hold in the end: whatever was answered
with 202 is stored once and has exactly one result, and no result that was seen once has ever changed.
"""

import argparse
import contextlib
import hashlib
import http.client
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import urllib.error
import urllib.request
import uuid
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import psycopg

from service.store.postgres.backup import check
from service.store.postgres.server import running_url
from tests.support.machines import Machine, Relay, children, command_of, started_with

ROOT = Path(__file__).parents[2]
RIGHT = (ROOT / "exercises/rigid_body/samples/right_terms.py").read_text()
ACTIONS = {  # how often each is drawn
    "kill a worker": 40,
    "freeze a worker": 12,
    "kill the other machine": 10,
    "cut off the other machine": 8,
    "kill the database": 16,
    "freeze the database": 6,
    "kill the server": 10,
    "stop the server": 4,
}
BACKLOG = 12  # clients wait while so many are open
SETTLE_S = 180.0


class Chaos:
    """One run on ``data``; ``seed`` draws what is done to whom."""

    def __init__(self, data: Path, port: int, seed: int = 1) -> None:
        data.parent.mkdir(parents=True, exist_ok=True)
        self.data, self.port, self.draw = data, port, random.Random(seed)
        self.sent: dict[str, str | None] = {}  # by key, the id that was answered
        self.seen: dict[str, str] = {}  # by grading, the digest of its result
        self.graded: set[str] = set()
        self.changed: list[str] = []
        self.done: Counter[str] = Counter()
        self.odd: Counter[str] = Counter()
        self._ending, self._lock = threading.Event(), threading.Lock()
        self._log = (data.parent / f"{data.name}.log").open("ab")
        self.server = self._serve()
        self.other = Machine(7, stdout=self._log, stderr=self._log)
        self._relay = Relay(self.other.ours, data)
        self._cut_until = 0.0
        self._timers: list[threading.Timer] = []
        self._start_other()

    def run(self, kills: int) -> dict[str, object]:
        """Do it, let everything settle, and count."""
        clients = [threading.Thread(target=self._send, args=(k,)) for k in range(3)] + [
            threading.Thread(target=self._watch)
        ]
        for client in clients:
            client.start()
        try:
            self._until(self._ready, 60)
            while sum(self.done.values()) < kills:
                time.sleep(self.draw.uniform(0.1, 1.6))
                self._harm()
                self._replace()
        finally:
            self._patience = time.monotonic() + 60
            self._ending.set()
            for client in clients:
                client.join()
        return self._count()

    def stop(self) -> None:
        """End everything that was started."""
        for timer in self._timers:
            timer.join()
        self.other.remove()
        self._relay.stop()
        self.server.terminate()
        self.server.wait(60)
        self._log.close()
        self.left = started_with(f"POLHODE_DATA={self.data}")

    def _harm(self) -> None:
        action = self.draw.choices(list(ACTIONS), list(ACTIONS.values()))[0]
        if action == "kill the server":
            self.server.kill()
        elif action == "stop the server":
            self.server.terminate()
        elif action == "kill the other machine":
            self.other.die()
        elif action == "cut off the other machine":
            if time.monotonic() < self._cut_until:
                return
            self.other.cut()
            self._cut_until = time.monotonic() + (seconds := self.draw.uniform(3.0, 8.0))
            self._later(seconds, self.other.heal)
        elif action.endswith("the database"):
            self._hit(self._postmaster(), action)
        elif workers := [*_grandchildren(self.server.pid), *self.other.workers()]:
            self._hit(self.draw.choice(workers), action)
        else:
            return
        self.done[action] += 1

    def _hit(self, pid: int | None, action: str) -> None:
        if pid is None:
            return
        try:
            if action.startswith("kill"):
                os.kill(pid, signal.SIGKILL)
            else:
                os.kill(pid, signal.SIGSTOP)
                self._later(self.draw.uniform(1.0, 5.0), _thaw, pid)
        except ProcessLookupError:
            pass

    def _later(self, seconds: float, function: Callable[..., None], *arguments: object) -> None:
        self._timers.append(threading.Timer(seconds, function, arguments))
        self._timers[-1].start()

    def _replace(self) -> None:
        """A supervisor, such as systemd, starts again what ended."""
        if self.server.poll() is not None:
            self.server = self._serve()
        if self.other.process.poll() is not None:
            self._start_other()

    def _start_other(self) -> None:
        url = f"postgresql://polhode@{self.other.ours}:{self._relay.port}/polhode?sslmode=disable"
        self.other.start(
            url, slots=2, POLHODE_DRAIN="1", OPENBLAS_NUM_THREADS="1", POLHODE_DATA=str(self.data)
        )

    def _serve(self) -> "subprocess.Popen[bytes]":
        own = {
            "POLHODE_DATA": str(self.data),
            "POLHODE_WORKERS": "2",
            "POLHODE_DRAIN": "1",
            "OMP_NUM_THREADS": "1",
        }
        environment = os.environ | own | {"OPENBLAS_NUM_THREADS": "1"}
        command = [sys.executable, "-m", "service.cli", "serve", "--port", str(self.port)]
        return subprocess.Popen(command, env=environment, stdout=self._log, stderr=self._log)

    def _postmaster(self) -> int | None:
        try:
            return int((self.data / "postgres/postmaster.pid").read_text().split("\n", 1)[0])
        except (OSError, ValueError, http.client.HTTPException):
            return None

    def _send(self, number: int) -> None:
        """A client: one submission after the other, each repeated until it is answered, some although it was
        answered.
        """
        draw = random.Random(1000 * number)
        while not self._ending.is_set():
            with self._lock:
                open_ = sum(id is None or id not in self.graded for id in self.sent.values())
            if open_ > BACKLOG:
                time.sleep(0.2)
                continue
            key = uuid.uuid4().hex
            with self._lock:
                self.sent[key] = None
            source = f"# {key}\n{RIGHT}"
            while (id := self._post(source, key)) is None:
                if self._ending.wait(0.2) and time.monotonic() > self._patience:
                    return  # there is no server any more: what made it so is told elsewhere
            if draw.random() < 0.3 and self._post(source, key) not in (None, id):
                self.odd["another id for the same key"] += 1
            with self._lock:
                self.sent[key] = id

    def _post(self, source: str, key: str) -> str | None:
        body = json.dumps({"source": source, "exercises": ["2"]}).encode()
        headers = {"Content-Type": "application/json", "Idempotency-Key": key}
        request = urllib.request.Request(
            f"http://127.0.0.1:{self.port}/v1/assignments/rigid-body/submissions", body, headers
        )
        try:
            with urllib.request.urlopen(request, timeout=20) as answer:
                return str(json.load(answer)["id"])
        except urllib.error.HTTPError as error:
            with error:
                if error.code != 503 or not error.headers["Retry-After"]:
                    self.odd[f"HTTP {error.code}"] += 1
        except (OSError, ValueError, http.client.HTTPException):
            pass  # no server, or it went away while it answered
        return None

    def _watch(self) -> None:
        """Read results as they come, and again: a result that changes would be two outcomes."""
        while not self._ending.wait(1.0):
            self._look()

    def _look(self) -> None:
        try:
            with psycopg.connect(running_url(self.data) or "", connect_timeout=2) as connection:
                rows = connection.execute(_RESULTS).fetchall()
        except psycopg.Error:
            return
        with self._lock:
            for submission, grading, told in rows:
                digest = hashlib.sha256(told.encode()).hexdigest()
                if self.seen.setdefault(str(grading), digest) != digest:
                    self.changed.append(str(grading))
                self.graded.add(str(submission))

    def _count(self) -> dict[str, object]:
        """Wait until all is graded, grade faults again as an instructor would, and compare with what was
        promised.
        """
        self._until(self._ready, 60)
        self._until(lambda: self._one(_OPEN) == 0)
        faults = self._one("SELECT count(*) FROM result WHERE fault IS NOT NULL")
        again = [sys.executable, "-m", "service.cli", "regrade", "--faults"]
        subprocess.run(
            again, env=os.environ | {"POLHODE_DATA": str(self.data)}, check=True, stdout=subprocess.DEVNULL
        )
        self._until(lambda: self._one(_OPEN) == 0)
        self._look()
        url = running_url(self.data)
        assert url is not None
        with psycopg.connect(url) as connection:
            stored = dict(connection.execute("SELECT idempotency_key, id::text FROM submission").fetchall())
            graded = {id for (id,) in connection.execute(_RIGHT).fetchall()}
            runs = dict(connection.execute("SELECT end_reason, count(*) FROM run GROUP BY 1").fetchall())
        accepted = {key: id for key, id in self.sent.items() if id is not None}
        return {
            "harm": sum(self.done.values()),
            "by kind": dict(self.done),
            "accepted": len(accepted),
            "stored": len(stored),
            "accepted, not stored": sum(stored.get(key) != id for key, id in accepted.items()),
            "stored, never sent": len(set(stored) - set(self.sent)),
            "accepted, without report": sum(id not in graded for id in accepted.values()),
            "results that changed": len(self.changed),
            "faults on the way": faults,
            "odd": dict(self.odd),
            "runs": runs,
            "does not fit": {sentence: n for sentence, n in check(url).items() if n},
        }

    def _one(self, query: str) -> int:
        try:
            with psycopg.connect(running_url(self.data) or "", connect_timeout=2) as connection:
                return int((connection.execute(query).fetchone() or (-1,))[0])
        except psycopg.Error:
            return -1

    def _open(self) -> object:
        """What is open, for who has to find out why."""
        try:
            with psycopg.connect(running_url(self.data) or "", connect_timeout=2) as connection:
                return [connection.execute(query).fetchall() for query in _LOOK]
        except psycopg.Error as error:
            return error

    def _ready(self) -> bool:
        self._replace()
        try:
            urllib.request.urlopen(f"http://127.0.0.1:{self.port}/readyz", timeout=5).close()
            return True
        except OSError:
            return False

    def _until(self, holds, seconds: float = SETTLE_S) -> None:
        until = time.monotonic() + seconds
        while not holds():
            assert time.monotonic() < until, f"not settled: {self._open()}; see {self._log.name}"
            time.sleep(0.3)


_OPEN = "SELECT count(*) FROM grading a LEFT JOIN result r ON r.grading_id = a.id WHERE r.grading_id IS NULL"
_LOOK = (
    f"{_OPEN.replace('count(*)', 'a.*')} LIMIT 5",
    "SELECT * FROM run WHERE ended_at IS NULL LIMIT 9",
    "SELECT id, task_name, priority, status, args, worker_id FROM procrastinate_jobs LIMIT 9",
    "SELECT *, now() FROM worker ORDER BY seen_at DESC LIMIT 9",
)
_RESULTS = (
    "SELECT submission_id, grading_id, coalesce(report::text, fault) FROM result JOIN grading ON id ="
    " grading_id"
)
_RIGHT = (
    "SELECT DISTINCT submission_id::text FROM grading JOIN result ON grading_id = id WHERE score = max_score"
)


def lost(told: dict[str, object]) -> list[str]:
    """What must be zero and is not."""
    must = (
        "accepted, not stored",
        "stored, never sent",
        "accepted, without report",
        "results that changed",
        "odd",
        "does not fit",
        "processes left",
    )
    return [f"{name}: {told[name]}" for name in must if told.get(name)]


def _grandchildren(pid: int) -> list[int]:
    """Workers of a server: its crew was started by another thread than the first."""
    crews = []
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        try:
            crews += [int(p) for p in task.read_text().split()]
        except OSError:
            continue
    return [w for crew in crews if b"--with-parent" in command_of(crew) for w in children(crew)]


def _thaw(pid: int) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.kill(pid, signal.SIGCONT)


def main() -> int:
    """Exit code 0 if nothing was lost."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--port", type=int, default=8765)
    given = parser.parse_args()
    # so that what was started is stopped, however this ends
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    folder, began = Path(tempfile.mkdtemp(prefix="polhode-chaos-")), time.monotonic()
    chaos = Chaos(folder / "data", given.port, given.seed)
    try:
        told = chaos.run(given.kills)
    finally:  # what went wrong can be looked at
        print(f"done: {dict(chaos.done)}, to be seen in {folder}", flush=True)
        chaos.stop()
    told["processes left"] = chaos.left
    if not lost(told):
        shutil.rmtree(folder)
    print(json.dumps(told, indent=1), f"\n{time.monotonic() - began:.0f} s")
    for line in lost(told):
        print(f"✗  {line}")
    return 1 if lost(told) else 0


if __name__ == "__main__":
    sys.exit(main())
