"""polhode as a server that is already running: one submission after another over HTTP."""

import time

import httpx2

from bench.peers.clock import Took, spent
from bench.peers.peer import Unread
from bench.peers.polhode import passed
from bench.peers.submissions import Submission
from bench.queue import ME, PATH


class Warm:
    """A client of the server whose first process is ``pid``; it stays connected."""

    def __init__(self, url: str, pid: int, submission: Submission) -> None:
        self.pid, self.submission, self.sent = pid, submission, 0
        self.client = httpx2.Client(base_url=url, headers=ME | {"Prefer": "wait=60"}, timeout=90, trust_env=False)

    def grade(self, count: int) -> list[Took]:
        """Each from sending a file that nobody has sent before to its whole report; CPU of the whole server, shared out evenly.

        Raises Unread unless each report is all ✓.
        """
        before = spent(self.pid)
        walls = [self._one() for _ in range(count)]
        return [Took(wall, (spent(self.pid) - before) / count) for wall in walls]

    def _one(self) -> float:
        self.sent += 1
        content = f"{self.submission.script}\n# {self.sent}\n".encode()
        began = time.perf_counter()
        answer = self.client.post(PATH, files={"file": ("work.py", content)}, data={"exercises": "2"})
        took = time.perf_counter() - began
        if answer.status_code != 200 or not passed(answer.json()["report"]).full:
            raise Unread(f"the server answered {answer.status_code}: {answer.text[:300]}")
        return took
