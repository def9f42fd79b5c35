"""polhode as a server that is already running: one submission after another over HTTP, or several at once."""

import itertools
import time
from concurrent.futures import ThreadPoolExecutor

import httpx2

from bench.peers.clock import Took, spent
from bench.peers.peer import Unread
from bench.peers.polhode import passed
from bench.peers.submissions import Submission
from bench.queue import ME, PATH


class Warm:
    """A client of the server whose first process is ``pid``; it stays connected."""

    def __init__(self, url: str, pid: int, submission: Submission) -> None:
        self.pid, self.submission, self._numbers = pid, submission, itertools.count(1)
        self.client = httpx2.Client(base_url=url, headers=ME | {"Prefer": "wait=60"}, timeout=90, trust_env=False)

    def grade(self, count: int) -> list[Took]:
        """Each from sending a file that nobody has sent before to its whole report; CPU of the whole server, shared out evenly.

        Raises Unread unless each report is all ✓.
        """
        before = spent(self.pid)
        walls = [self._one() for _ in range(count)]
        return [Took(wall, (spent(self.pid) - before) / count) for wall in walls]

    def at_once(self, count: int) -> list[Took]:
        """All of them, sent at the same time, until the last report is there."""
        before, began = spent(self.pid), time.perf_counter()
        with ThreadPoolExecutor(count) as senders:
            list(senders.map(lambda _: self._one(), range(count)))
        return [Took(time.perf_counter() - began, spent(self.pid) - before)]

    def _one(self) -> float:
        number = next(self._numbers)
        content = f"{self.submission.script}\n# {number}\n".encode()
        began = time.perf_counter()
        answer = self.client.post(PATH, files={"file": ("work.py", content)}, data={"exercises": "2"})
        took = time.perf_counter() - began
        if answer.status_code != 200 or not passed(answer.json()["report"]).full:
            raise Unread(f"the server answered {answer.status_code}: {answer.text[:300]}")
        return took
