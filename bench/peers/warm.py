"""polhode as a running server: one submission after the other over HTTP, or several at the same time."""

import itertools
import json
import time
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor

import httpx2

from bench.forms import FORMS
from bench.peers.clock import Timing, spent
from bench.peers.peer import NoMarks
from bench.peers.polhode import passed
from bench.peers.submissions import FOLDER, Submission, code_cell
from bench.queue import ME, PATH

NOTEBOOK = FOLDER / "samples" / "right_course_notebook.ipynb"
IDLE_S = 0.05


class Warm:
    """A connected client of the server whose first process is ``pid``."""

    def __init__(self, url: str, pid: int, submissions: Mapping[str, Submission]) -> None:
        self.pid, self._submissions, self._numbers = pid, submissions, itertools.count(1)
        self.client = httpx2.Client(
            base_url=url, headers=ME | {"Prefer": "wait=60"}, timeout=90, trust_env=False
        )

    def grade_forms(self) -> list[Timing]:
        """Return the time of each of the FORMS from sending the file to receiving its report.

        Raises NoMarks unless each report is all ✓.
        """
        return [self._timed(lambda form=form: self._form(form)) for form in FORMS]

    def grade_notebook(self) -> list[Timing]:
        """Return the time of the course's whole notebook. Raises NoMarks unless its report is all ✓."""
        notebook = json.loads(NOTEBOOK.read_text())
        notebook["cells"].append(code_cell("number", f"# {next(self._numbers)}"))
        files = {"file": ("work.ipynb", json.dumps(notebook).encode())}
        return [self._timed(lambda: self._post(files, {}))]

    def grade_together(self, count: int) -> list[Timing]:
        """Return the time until the last report of ``count`` submissions sent at the same time."""
        before, began = spent(self.pid), time.perf_counter()
        with ThreadPoolExecutor(count) as senders:
            list(senders.map(self._form, itertools.islice(itertools.cycle(FORMS), count)))
        return [Timing(time.perf_counter() - began, spent(self.pid) - before)]

    def _timed(self, grade: Callable[[], None]) -> Timing:
        before, began = spent(self.pid), time.perf_counter()
        grade()
        wall = time.perf_counter() - began
        time.sleep(IDLE_S)  # until its last process has exited
        return Timing(wall, spent(self.pid) - before)

    def _form(self, form: str) -> None:
        content = f"{self._submissions[form].script}\n# {next(self._numbers)}\n".encode()
        self._post({"file": ("work.py", content)}, {"exercises": "2"})

    def _post(self, files: Mapping[str, tuple[str, bytes]], fields: Mapping[str, str]) -> None:
        answer = self.client.post(PATH, files=files, data=fields)
        if answer.status_code != 200 or not passed(answer.json()["report"]).full:
            raise NoMarks(f"the server answered {answer.status_code}: {answer.text[:300]}")
