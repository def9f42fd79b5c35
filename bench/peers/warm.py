"""polhode as a running server: one submission after the other over HTTP, or several at the same time."""

import itertools
import time
from concurrent.futures import ThreadPoolExecutor

import httpx2

from bench.peers.clock import Timing, spent
from bench.peers.peer import NoMarks
from bench.peers.polhode import passed
from bench.peers.submissions import Submission
from bench.queue import ME, PATH


class Warm:
    """A connected client of the server whose first process is ``pid``."""

    def __init__(self, url: str, pid: int, submission: Submission) -> None:
        self.pid, self.submission, self._numbers = pid, submission, itertools.count(1)
        self.client = httpx2.Client(
            base_url=url, headers=ME | {"Prefer": "wait=60"}, timeout=90, trust_env=False
        )

    def grade(self, count: int) -> list[Timing]:
        """Return the time of each new submission from sending the file to receiving its report; the server's
        CPU time is shared evenly.

        Raises NoMarks unless each report is all ✓.
        """
        before = spent(self.pid)
        walls = [self._one() for _ in range(count)]
        return [Timing(wall, (spent(self.pid) - before) / count) for wall in walls]

    def grade_together(self, count: int) -> list[Timing]:
        """Return the time until the last report of ``count`` submissions sent at the same time."""
        before, began = spent(self.pid), time.perf_counter()
        with ThreadPoolExecutor(count) as senders:
            list(senders.map(lambda _: self._one(), range(count)))
        return [Timing(time.perf_counter() - began, spent(self.pid) - before)]

    def _one(self) -> float:
        number = next(self._numbers)
        content = f"{self.submission.script}\n# {number}\n".encode()
        began = time.perf_counter()
        answer = self.client.post(PATH, files={"file": ("work.py", content)}, data={"exercises": "2"})
        took = time.perf_counter() - began
        if answer.status_code != 200 or not passed(answer.json()["report"]).full:
            raise NoMarks(f"the server answered {answer.status_code}: {answer.text[:300]}")
        return took
