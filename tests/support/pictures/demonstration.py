"""A demonstration of its own, whose pages the pictures show."""

import os
import subprocess
import sys
import time
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from service.cli.server.database import database_url
from service.cli.server.demo import free_port
from service.grading.submission import Submission
from service.settings import Settings
from service.store.queue.overview import regrade
from service.store.submissions.accepting import accept
from service.store.submissions.records import NewSubmission
from tests.support.database import run, sql

RUNNING = "The server is running"
# A busy machine takes longer to start a server than a visitor would wait.
PATIENT = "import sys; from service.cli.server import demo; demo.START_S = 300.0; sys.exit(demo.main())"
OPEN = "SELECT 1 FROM grading g LEFT JOIN result r ON r.grading_id = g.id WHERE r.grading_id IS NULL LIMIT 1"


class Demonstration(NamedTuple):
    """The address of the server, on which nobody logs in, and that of its database."""

    address: str
    database: str


@contextmanager
def demonstration(folder: Path, *, with_class: bool = True) -> Iterator[Demonstration]:
    """Provide a demonstration with its data in ``folder``, as soon as its samples are graded, and its class
    too, which takes minutes, if the pictures show it.
    """
    port, log = free_port(), folder / "demo.log"
    environment = {k: v for k, v in os.environ.items() if not k.startswith("POLHODE_")}
    environment |= {"POLHODE_DATA": str(folder / "data"), "POLHODE_WORKERS": "1"}
    with log.open("wb") as lines:
        process = subprocess.Popen(
            [sys.executable, "-c", PATIENT, "--port", str(port)], env=environment, stdout=lines, stderr=lines
        )
    try:
        while RUNNING not in log.read_text(encoding="utf-8"):
            if process.poll() is not None:
                raise SystemExit(f"the demonstration ended:\n{log.read_text(encoding='utf-8')[-2000:]}")
            time.sleep(0.5)
        with database_url(Settings(data=folder / "data")) as url:
            if with_class:
                wait_for_gradings(url)
            yield Demonstration(f"http://127.0.0.1:{port}", url)
    finally:
        process.terminate()
        process.wait(60)


def submit(url: str, person: str, filename: str, source: str, exercises: list[str]) -> uuid.UUID:
    """Store a student's submission to rigid-body, which the demonstration grades, and return its id."""
    new = NewSubmission(uuid.uuid4(), "rigid-body", person, Submission(source, filename, exercises), seed=7)
    run(url, lambda database: accept(database, new))
    return new.id


def wait_for_gradings(url: str) -> None:
    """Return when everything is graded; what a busy machine could not grade is graded again."""
    while sql(url, OPEN) or run(url, lambda database: regrade(database, "faults", "local")):
        time.sleep(1)
