"""A surge of submissions before a deadline on a real server: losses, waits, and the waits that ``bench.plan``
predicts.

``python -m bench.surge`` takes five minutes on two cores, and ``--notebook`` fifteen. Students send the
samples below at times drawn as ``bench.plan`` draws them. The waits are read from the database and compared
with a simulation of the same arrivals and with what ``bench.plan`` predicts. ``--write`` stores the
measured grading times for ``bench.plan``. With ``--slow 3`` three of the students send files that run until
they are stopped, each time another one, and the waits of all others are compared with those of the same
surge without these students' slow files. With ``--waits`` gradings are waits of the
measured times, so that other work on the machine changes little.
"""

import argparse
import asyncio
import contextlib
import json
import os
import platform
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import pairwise
from pathlib import Path

import httpx2
import numpy as np
import psycopg

from bench.plan import MEASURED, Arrivals, Deadline, draw, measured, start_times, summary, table
from bench.stand_ins import be_workers, record
from exercises.authoring.assignments.catalogue import find
from service.cli.server.demo import free_port
from service.store.postgres.server import running_url

SUBMISSIONS = 3
RIGHT = ("cross", "terms", "roll", "oop", "cross_solve", "einsum_levi_civita", "skew_matrix", "list_return")
WRONG = (
    "sign_first",
    "sign_all",
    "divisor",
    "factor_two_all",
    "shape",
    "raises",
    "syntax",
    "product_all_shifted",
)
NOTEBOOKS = (
    "right_course_notebook.ipynb",
    "right_notebook.ipynb",
    "right_notebook_with_checks.ipynb",
    "wrong_notebook.ipynb",
    "right_all.py",
    "right_greek_whole_notebook.py",
)
SLACK_S = 1.0  # two times this far apart are surely in order
WHAT = {
    "exercise": f"exercise 2 of {len(RIGHT)} right and {len(WRONG)} wrong samples",
    "notebook": f"{len(NOTEBOOKS)} samples with all exercises",
}
START_S, STOP_S, ANSWER_S = 240.0, 60.0, 60.0
GROWTH_S = 5.0  # a wait may grow by, as each slow file is given a few seconds before it is known to be slow


@dataclass(frozen=True)
class Answer:
    """The response to one POST: its status or an error's name, the seconds it took,
    and how late it was sent.
    """

    status: int | str
    took_s: float
    late_s: float


@dataclass(frozen=True)
class Row:
    """One grading as recorded in the database; times are seconds since the epoch."""

    person: str
    requested: float
    started: float | None
    finished: float | None
    grading: float | None
    fault: str | None
    runs: int
    worker: str | None


def main() -> int:
    """Return 0 if every submission was accepted and graded in the right order."""
    parser = argparse.ArgumentParser(prog="bench.surge", description=__doc__)
    parser.add_argument("--students", type=int, default=300)
    parser.add_argument(
        "--seconds", type=float, default=120.0, help="seconds before the deadline in which they submit"
    )
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    parser.add_argument("--notebook", action="store_true", help="send whole notebooks; default: exercise 2")
    parser.add_argument("--slow", type=int, default=0, metavar="N", help="students whose files are slow")
    parser.add_argument("--waits", action="store_true", help="wait as long as gradings were measured to take")
    parser.add_argument("--be-workers", type=Path, metavar="FILE", help=argparse.SUPPRESS)
    parser.add_argument("--rush", action="store_true", help="submission rate grows towards the deadline")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument(
        "--most", type=float, default=1800.0, metavar="SECONDS", help="give up after this time"
    )
    parser.add_argument("--write", action="store_true", help=f"store the grading times in {MEASURED.name}")
    arguments = parser.parse_args()
    if arguments.be_workers:
        times = measured("notebook" if arguments.notebook else "exercise")
        be_workers(arguments.be_workers, lambda given, seed: wait_s(given.source, times[seed % len(times)]))
        return 0
    for how in (signal.SIGINT, signal.SIGTERM):
        signal.signal(how, signal.default_int_handler)
    minutes = arguments.seconds / 60
    kind = "notebook" if arguments.notebook else "exercise"
    asked = Deadline(
        arguments.students,
        minutes,
        arguments.workers,
        SUBMISSIONS,
        arguments.rush,
        arguments.seed,
        seconds=measured(kind),
    )
    until = time.monotonic() + arguments.most
    answers, rows, began = surge(asked, kind, until, waits=arguments.waits)
    failed = report(asked, answers, rows, began, kind if arguments.write else None)
    if arguments.slow:
        _, slowed, _ = surge(asked, kind, until, arguments.slow, waits=arguments.waits)
        failed |= compare(rows, slowed, arguments.slow)
    return failed


def surge(
    asked: Deadline, kind: str, until: float, slow: int = 0, *, waits: bool
) -> tuple[list[Answer], list[Row], float]:
    """Run the surge on a server of its own, in which the first ``slow`` students send slow files.

    Return the responses, every grading, and the time of the begin in seconds since the epoch.
    """
    with server(asked.workers, kind if waits else None) as (url, database):
        began = time.time()
        answers = asyncio.run(send(url, draw(asked), bodies(kind), asked.seed, slow))
        accepted = sum(a.status in (200, 202) for a in answers) - slow * asked.submissions
        return answers, results(database, accepted, until, but=names(slow)), began


def names(students: int) -> list[str]:
    """Return the names of the first students."""
    return [f"s{person:04}" for person in range(students)]


@contextlib.contextmanager
def server(workers: int, waits: str | None = None) -> Iterator[tuple[str, str]]:
    """Run a server with ``workers`` warm workers; yield its URL and its database's URL.

    With ``waits`` these wait as long as gradings of that kind.
    """
    with tempfile.TemporaryDirectory(prefix="surge-", ignore_cleanup_errors=True) as folder:
        data, log, port = Path(folder) / "polhode", Path(folder) / "log", free_port()
        environment = {
            k: v
            for k, v in os.environ.items()
            if not k.startswith("POLHODE_") and k != "PYTHONDONTWRITEBYTECODE"
        }
        environment |= {
            "POLHODE_DATA": str(data),
            "POLHODE_WORKERS": "0" if waits else str(workers),
            "POLHODE_PERSON_HEADER": "Remote-User",
        }
        environment |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        command = [sys.executable, "-m", "service.cli", "serve", "--port", str(port)]
        stand_ins = None
        with log.open("wb") as stream:
            process = subprocess.Popen(command, env=environment, stdout=stream, stderr=stream)
        try:
            if waits:
                record(Path(folder) / "recorded")
                stand_ins = _start_stand_ins(Path(folder) / "recorded", data, workers, waits)
            url = f"http://127.0.0.1:{port}"
            database = _ready(process, url, data, workers)
            publish(database)
            yield url, database
        finally:
            if stand_ins is not None:
                stand_ins.terminate()
                stand_ins.wait(STOP_S)
            process.send_signal(signal.SIGTERM)
            try:
                process.wait(STOP_S)
            finally:
                process.kill()
                lines = log.read_text(errors="replace").splitlines()
                print(
                    f"the server ended with {process.poll()} and logged {len(lines)} lines",
                    *lines[-10:],
                    sep="\n  ",
                )


def publish(database: str) -> None:
    """Let students submit to the assignment, which is a draft in a new course."""
    with psycopg.connect(database) as connection:
        connection.execute("UPDATE assignment SET published = true WHERE slug = 'rigid-body'")


def _start_stand_ins(recorded: Path, data: Path, workers: int, kind: str) -> "subprocess.Popen[bytes]":
    until = time.monotonic() + START_S
    while (url := running_url(data)) is None:
        if time.monotonic() > until:
            raise RuntimeError("the server did not start")
        time.sleep(0.2)
    own = {"POLHODE_DATABASE_URL": url, "POLHODE_WORKERS": str(workers), "POLHODE_DRAIN": "0"}
    kinds = ["--notebook"] if kind == "notebook" else []
    command = [sys.executable, "-m", "bench.surge", "--be-workers", str(recorded), *kinds]
    return subprocess.Popen(command, env=os.environ | own)


def wait_s(source: str, usual: float) -> float:
    """Return the time of a submission's grading in s: ``usual``, unless its source begins with a sleep."""
    asleep = re.match(r"import time\ntime\.sleep\((\d+)\)", source)
    return min(120.0, float(asleep[1])) if asleep else usual


def bodies(kind: str) -> list[dict[str, object]]:
    """Return the requests to choose from: exercise 2 of short samples, or whole notebooks."""
    folder = find("rigid-body").folder / "samples"
    if kind == "notebook":
        return [{"source": (folder / name).read_text(), "filename": name} for name in NOTEBOOKS]
    names = [f"right_{name}.py" for name in RIGHT] + [f"wrong_{name}.py" for name in WRONG]
    return [{"source": (folder / name).read_text(), "filename": name, "exercises": ["2"]} for name in names]


async def send(
    url: str, arrivals: Arrivals, choice: list[dict[str, object]], seed: int, slow: int = 0
) -> list[Answer]:
    """Send every submission at its time and return the responses in the same order."""
    chosen = [
        choice[k] for k in np.random.default_rng(seed).integers(len(choice), size=len(arrivals.accepted))
    ]
    limits, zero = httpx2.Limits(max_connections=100, max_keepalive_connections=100), time.monotonic()
    async with httpx2.AsyncClient(base_url=url, timeout=ANSWER_S, limits=limits, trust_env=False) as client:

        async def one(moment: float, person: int, turn: int, body: dict[str, object]) -> Answer:
            await asyncio.sleep(zero + moment - time.monotonic())
            if person < slow:
                body = body | {"source": f"import time\ntime.sleep(600)  # {person}, {turn}\n"}
            headers = {"Remote-User": f"s{person:04}", "Idempotency-Key": f"{person}-{turn}"}
            sent = time.monotonic()
            try:
                status = (
                    await client.post("/v1/assignments/rigid-body/submissions", json=body, headers=headers)
                ).status_code
            except httpx2.HTTPError as error:
                status = type(error).__name__
            return Answer(status, time.monotonic() - sent, sent - zero - moment)

        each = zip(
            arrivals.accepted.tolist(), arrivals.person.tolist(), arrivals.turn.tolist(), chosen, strict=True
        )
        return await asyncio.gather(*(one(*a) for a in each))


def results(database: str, accepted: int, until: float, but: Sequence[str] = ()) -> list[Row]:
    """Return every grading in order of acceptance, once ``accepted`` of them have a result, apart from those
    of the people ``but``, or at ``until``.
    """
    with psycopg.connect(database, autocommit=True) as connection:
        while time.monotonic() < until:
            if connection.execute(_GRADED, (list(but),)).fetchone()[0] >= accepted:
                break
            time.sleep(1.0)
        return [Row(*row) for row in connection.execute(_ROWS).fetchall()]


_GRADED = """
SELECT count(*) FROM result r JOIN grading a ON a.id = r.grading_id
    JOIN submission s ON s.id = a.submission_id JOIN person p ON p.id = s.person_id WHERE p.name <> ALL(%s)
"""

_ROWS = """
SELECT p.name, extract(epoch FROM a.requested_at)::float, extract(epoch FROM min(u.started_at))::float,
    extract(epoch FROM r.finished_at)::float, r.grading_s, r.fault, count(u.id),
      max(u.worker) FILTER (WHERE u.id = r.run_id)
FROM grading a JOIN submission s ON s.id = a.submission_id JOIN person p ON p.id = s.person_id
    LEFT JOIN result r ON r.grading_id = a.id LEFT JOIN run u ON u.grading_id = a.id
GROUP BY p.name, a.id, r.grading_id ORDER BY a.requested_at, a.id
"""


def report(asked: Deadline, answers: list[Answer], rows: list[Row], began: float, write: str | None) -> int:
    """Print the results, and store the grading times as those of the kind ``write``, if it is given.

    Return 0 if no submission was refused, lost, faulted or overtaken.
    """
    refused = [a.status for a in answers if a.status not in (200, 202)]
    graded = [r for r in rows if r.grading is not None and r.started is not None]
    faults = [r.fault for r in rows if r.fault is not None]
    lost = max(len(answers) - len(refused), len(rows)) - len(graded) - len(faults)
    took, late = (np.array([getattr(a, name) for a in answers]) for name in ("took_s", "late_s"))
    print(
        f"{asked.students} students, {len(answers)} submissions in {60 * asked.minutes:g} s, {asked.workers}"
        " workers"
    )
    print(f"answers other than 200 and 202: {len(refused)} {sorted(set(map(str, refused)))}")
    p50, p99, most = 1e3 * np.quantile(took, [0.5, 0.99, 1.0])
    print(
        f"accepted after {p50:.0f} ms (p50), {p99:.0f} ms (p99), {most:.0f} ms (max); sent at most"
        f" {1e3 * late.max():.0f} ms late"
    )
    print(
        f"sent {len(answers)}, stored {len(rows)}, graded {len(graded)}, faults {len(faults)} {faults[:3]},"
        f" lost {lost}"
    )
    print(f"graded more than once {sum(r.runs > 1 for r in rows)}")
    if not graded:
        return 1
    spent = occupied(graded)
    arrivals, begun = _arrivals(graded, spent, began), np.array([r.started for r in graded]) - began
    wrong = overtaken(graded)
    thirds = sum(bool(arrivals.turn[k] == 3 and arrivals.turn[other] == 1) for k, other in wrong)
    print(
        f"pairs started in the wrong order: {len(wrong)}; of these a third submission before a first:"
        f" {thirds}"
    )
    for k, other in wrong[:3]:
        print(f"  {_times(graded[k], began)} before {_times(graded[other], began)}")
    more = spent.mean() - np.mean([r.grading for r in graded])
    print(f"a worker is busy {spent.mean():.3f} s per submission, {more:.3f} s more than the grading")
    planned = draw(asked)
    for name, which, when in (
        ("measured", arrivals, begun),
        (
            "predicted for these arrivals and these grading times",
            arrivals,
            start_times(arrivals, asked.workers),
        ),
        ("predicted by bench.plan", planned, start_times(planned, asked.workers)),
    ):
        print(f"\n{name}\n{table(summary(which, when, asked.workers, 60 * asked.minutes))}")
    if write:
        _write(asked, write, spent)
    return 1 if refused or lost or faults or wrong else 0


def compare(rows: list[Row], slowed: list[Row], slow: int) -> int:
    """Print the waits without and with slow files, of the students who sent none.

    Return 0 if no wait has grown by more than GROWTH_S.
    """
    waits, senders = {}, names(slow)
    for name, surge_ in (("without slow files", rows), (f"with {slow} slow students", slowed)):
        each = [r for r in sorted(surge_, key=lambda r: (r.person, r.requested)) if r.person not in senders]
        waits[name] = np.array([np.inf if r.started is None else r.started - r.requested for r in each])
        p50, p99, most = np.quantile(waits[name], [0.5, 0.99, 1.0])
        print(f"{name}: others waited {p50:.2f} s (p50), {p99:.2f} s (p99), {most:.2f} s (max)")
    before, after = waits.values()
    grown = after - before if before.shape == after.shape else np.array([np.inf])
    put_off = [r for r in slowed if r.person in senders]
    print(
        f"a wait grew by {grown.mean():.2f} s on average, {grown.max():.2f} s at most (goal {GROWTH_S:g} s);"
        f" slow files started {sum(r.runs for r in put_off)} runs"
    )
    return int(grown.max() > GROWTH_S)


def occupied(rows: list[Row]) -> np.ndarray:
    """Return the time that each submission occupied its worker (n,): its grading, plus the average overhead
    per job.

    The overhead is the time between two starts of a worker beyond grading, where the second submission was
    already waiting.
    """
    grading, more = np.array([r.grading for r in rows]), []
    for name in {r.worker for r in rows}:
        own = sorted((r for r in rows if r.worker == name), key=lambda r: r.started)
        more += [b.started - a.started - a.grading for a, b in pairwise(own) if b.requested < a.started]
    return grading + (
        np.mean(more) if more else np.median([r.finished - r.started - r.grading for r in rows])
    )


def overtaken(rows: list[Row]) -> list[tuple[int, int]]:
    """Return pairs of indices into ``rows``: a submission, and an earlier one that it overtook.

    By the queue's rule there is none: each student's oldest unfinished submission waits in order of becoming
    so, and others start only if no such submission waits.
    """
    started, oldest = np.array([r.started for r in rows]), _oldest(rows)
    found = []
    for k in range(len(rows)):
        waiting, before = started > started[k] + SLACK_S, oldest < min(oldest[k], started[k]) - SLACK_S
        found += [(k, int(other)) for other in np.flatnonzero(waiting & before)]
    return found


def _times(row: Row, began: float) -> str:
    return f"{row.person} (accepted at {row.requested - began:.3f} s, started at {row.started - began:.3f} s)"


def _oldest(rows: list[Row]) -> np.ndarray:
    """Return the time since when each submission has been its student's oldest unfinished one (n,)."""
    return np.array([
        max([r.requested,
            *(o.finished for o in rows if o.person == r.person and o.requested < r.requested)]) for r in rows
    ])  # fmt: skip


def _arrivals(rows: list[Row], service: np.ndarray, began: float) -> Arrivals:
    names, turns = sorted({r.person for r in rows}), {}
    person = np.array([names.index(r.person) for r in rows])
    turn = np.array([turns.setdefault(r.person, []).append(0) or len(turns[r.person]) for r in rows])
    return Arrivals(np.array([r.requested for r in rows]) - began, person, turn, service)


def _ready(process: subprocess.Popen[bytes], url: str, data: Path, workers: int) -> str:
    """Return the database's URL once the server responds and every worker is warm."""
    until = time.monotonic() + START_S
    while time.monotonic() < until and process.poll() is None:
        time.sleep(0.2)
        try:
            if httpx2.get(f"{url}/readyz", trust_env=False).status_code == 200 and (
                database := running_url(data)
            ):
                with psycopg.connect(database) as connection:
                    if (
                        connection.execute(
                            "SELECT count(*) FROM worker WHERE isolation IS NOT NULL"
                        ).fetchone()[0]
                        >= workers
                    ):
                        return database
        except httpx2.HTTPError:
            continue
    raise RuntimeError("the server did not start")


def _write(asked: Deadline, kind: str, seconds: np.ndarray) -> None:
    models = [
        line.split(":")[1].strip()
        for line in Path("/proc/cpuinfo").read_text().splitlines()
        if line.startswith("model name")
    ]
    document = {
        "measured_at": datetime.now(UTC).isoformat(timespec="seconds"),
        "machine": (
            f"{(models or [platform.machine()])[0]}, {os.cpu_count()} cores, Python"
            f" {platform.python_version()}"
        ),
        "what": (
            f"{WHAT[kind]}, from start to the worker's next start, by bench.surge with {asked.students}"
            f" students, {60 * asked.minutes:g} s and {asked.workers} workers"
        ),
        "seconds": [round(float(s), 4) for s in seconds],
    }
    known = json.loads(MEASURED.read_text()) | {kind: document}
    MEASURED.write_text(json.dumps(known, ensure_ascii=False, indent=0) + "\n")
    print(f"\nwritten to {MEASURED}")


if __name__ == "__main__":
    sys.exit(main())
