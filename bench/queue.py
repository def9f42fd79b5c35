"""Cost of store and queue: accepting, starting, recovery, idling, and a grading through them against a direct
one.

All measurements use a real ``polhode serve`` in a temporary folder. The goals hold for an idle machine with
two cores.
"""

import asyncio
import contextlib
import os
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import httpx2
import psycopg

from bench.surge import publish
from service.cli.server.demo import free_port
from service.grading.grader import Grader
from service.grading.submission import Submission
from service.sandbox.isolation.select import choose
from service.sandbox.sandbox import Sandbox
from service.store.postgres.server import running_url

PATH = "/v1/assignments/rigid-body/submissions"
SOURCE = "def euler_eqs(t, w, I):\n    return -np.cross(w, I * w) / I\n"
FAST = {"source": SOURCE, "exercises": ["2"]}
ME = {"Remote-User": "me"}
SLOW = {"source": "import time\ntime.sleep(2)\n" + SOURCE, "exercises": ["2"]}


def main() -> None:
    """Measure and print one line per measurement."""
    with server(workers=0) as (url, _, _):
        accepting(url, "accepting at 50/s, no worker")
    with server(workers=1) as (url, data, process):
        idle(process)
        starting(url, data)
        through, direct = overhead(url)
        line(
            "exercise 2, through HTTP, queue and store",
            1e3 * through,
            "ms",
            f"directly {1e3 * direct:.0f} ms",
        )
        line("  overhead", 100 * (through / direct - 1), "%", "goal 10 %")
    with server(workers=2) as (url, data, process):
        idle(process)
        takeover(url, data)
        restart(url, data)
        accepting(url, "accepting at 50/s, two workers grading")


@contextlib.contextmanager
def server(workers: int) -> Iterator[tuple[str, Path, "subprocess.Popen[bytes]"]]:
    """Run a server on a free port; yield its URL, data folder and process."""
    port = free_port()
    with tempfile.TemporaryDirectory(prefix="polhode-bench-") as folder:
        data = Path(folder) / "data"
        own = {
            "POLHODE_DATA": str(data),
            "POLHODE_WORKERS": str(workers),
            "POLHODE_PERSON_HEADER": "Remote-User",
        }
        environment = os.environ | own
        process = subprocess.Popen(
            [sys.executable, "-m", "service.cli", "serve", "--port", str(port)], env=environment
        )
        url = f"http://127.0.0.1:{port}"
        try:
            until = time.monotonic() + 60
            while time.monotonic() < until:
                with contextlib.suppress(httpx2.HTTPError):
                    if httpx2.get(f"{url}{'/readyz' if workers else '/livez'}").status_code == 200:
                        break
                time.sleep(0.1)
            publish(running_url(data) or "")
            time.sleep(2)
            yield url, data, process
        finally:
            process.terminate()
            process.wait(60)


def accepting(url: str, name: str, rate: float = 50.0, seconds: float = 10.0) -> None:
    """Measure the time to a durable 202 for submissions at a constant rate, independent of the responses."""

    async def send() -> list[float]:
        times: list[float] = []
        async with httpx2.AsyncClient(timeout=30) as client:

            async def one(k: int) -> None:
                began = time.perf_counter()
                answer = await client.post(
                    url + PATH, json=FAST, headers={"Remote-User": f"student {k % 40}"}
                )
                assert answer.status_code == 202
                times.append(time.perf_counter() - began)

            pending, began = [], time.perf_counter()
            for k in range(int(rate * seconds)):
                await asyncio.sleep(max(0.0, began + k / rate - time.perf_counter()))
                pending.append(asyncio.create_task(one(k)))
            await asyncio.gather(*pending)
        return times

    times = asyncio.run(send())
    line(
        name,
        1e3 * statistics.median(times),
        "ms",
        f"p99 {1e3 * quantile(times, 0.99):.0f} ms; goal 10 and 50 on an idle machine",
    )


def starting(url: str, data: Path, count: int = 60) -> None:
    """Measure the time from the response 202 to the start of the run, one submission at a time on an idle
    machine.
    """
    answered = {}
    with httpx2.Client(headers=ME, timeout=40) as client:
        for _ in range(count):
            id = client.post(url + PATH, json=FAST).json()["id"]
            answered[id] = time.time()
            wait(lambda id=id: client.get(f"{url}/v1/submissions/{id}").json()["status"] == "graded")
            time.sleep(0.05)
    began = (
        "SELECT submission_id::text, extract(epoch FROM started_at) FROM run JOIN grading a ON a.id ="
        " grading_id"
    )
    times = [max(0.0, float(s) - answered[id]) for id, s in query(data, began)]
    line(
        "accepted to started",
        1e3 * statistics.median(times),
        "ms",
        f"p99 {1e3 * quantile(times, 0.99):.0f} ms; goal 5 and 20",
    )


def overhead(url: str, count: int = 25) -> tuple[float, float]:
    """Return the median times of a grading over HTTP and of the same grading in this process, interleaved."""
    grader = Grader(Sandbox(choose()))
    grader.ready()
    submission, through, direct = Submission(SOURCE, exercises=["2"]), [], []
    with httpx2.Client(headers=ME | {"Prefer": "wait=30"}, timeout=40) as client:
        for seed in range(count):
            began = time.perf_counter()
            client.post(url + PATH, json=FAST)
            through.append(time.perf_counter() - began)
            began = time.perf_counter()
            grader.grade_and_pack(submission, "rigid-body", seed, lambda phase, scene, scenes: None)
            direct.append(time.perf_counter() - began)
    return statistics.median(through), statistics.median(direct)


def takeover(url: str, data: Path, count: int = 6) -> None:
    """Measure the time from SIGKILL of a worker during a grading to the start of the next run on the other
    worker.
    """
    times = []
    for _ in range(count):
        id = httpx2.post(url + PATH, json=SLOW, headers=ME, timeout=30).json()["id"]
        runs = (
            f"SELECT worker FROM run JOIN grading a ON a.id = grading_id WHERE submission_id = '{id}' ORDER"
            " BY run.started_at"
        )
        (worker,) = wait(lambda runs=runs: query(data, runs))[0]
        time.sleep(0.8)
        began = time.perf_counter()
        os.kill(int(worker.split("/")[1]), signal.SIGKILL)
        wait(lambda runs=runs: len(query(data, runs)) == 2)
        times.append(time.perf_counter() - began)
        wait(lambda id=id: httpx2.get(f"{url}/v1/submissions/{id}", headers=ME).json()["status"] == "graded")
    line(
        "killed worker's submission restarted after",
        statistics.median(times),
        "s",
        f"at most {max(times):.1f} s; goal 5",
    )


def restart(url: str, data: Path, count: int = 5) -> None:
    """Measure the time from SIGKILL of the database to the start of the first submission after it."""
    times = []
    for _ in range(count):
        os.kill(int((data / "postgres/postmaster.pid").read_text().split("\n")[0]), signal.SIGKILL)
        began = time.perf_counter()
        accepted = wait(lambda: httpx2.post(url + PATH, json=FAST, headers=ME, timeout=30).status_code == 202)
        assert accepted
        wait(lambda: query(data, "SELECT 1 FROM run WHERE started_at > pg_postmaster_start_time()"))
        times.append(time.perf_counter() - began)
        time.sleep(2)
    line(
        "database killed to first submission started",
        statistics.median(times),
        "s",
        f"at most {max(times):.1f} s; goal 5",
    )


def idle(process: "subprocess.Popen[bytes]", seconds: float = 20.0) -> None:
    """Measure the CPU load (% of a core) and memory (proportional set sizes) of all processes but the
    guests.
    """
    processes = [p for p in tree(process.pid) if "bwrap" not in command(p) and "-I -S" not in command(p)]
    before = sum(ticks(p) for p in processes)
    time.sleep(seconds)
    cpu = 100 * (sum(ticks(p) for p in processes) - before) / os.sysconf("SC_CLK_TCK") / seconds
    line("idle: CPU without guests", cpu, "%", "goal 3 % of a core")
    line("      memory without guests", sum(proportional(p) for p in processes) / 1024, "MB", "goal 350")


def tree(pid: int) -> list[int]:
    """Return the process ids of a process and all its descendants."""
    below = [int(p) for f in Path(f"/proc/{pid}/task").glob("*/children") for p in f.read_text().split()]
    return [pid, *(q for p in below for q in tree(p))]


def command(pid: int) -> str:
    """Return the command line of a process."""
    return Path(f"/proc/{pid}/cmdline").read_text().replace("\0", " ")


def ticks(pid: int) -> int:
    """Return the user and system time of a process, in clock ticks."""
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return int(fields[11]) + int(fields[12])


def proportional(pid: int) -> int:
    """Return the proportional set size of a process in KiB."""
    return sum(
        int(w.split()[1])
        for w in Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
        if w.startswith("Pss:")
    )


def query(data: Path, statement: str) -> list[tuple]:
    """Return the rows of a query on the embedded database, none while it is unavailable."""
    try:
        with psycopg.connect(running_url(data) or "", connect_timeout=2) as connection:
            return connection.execute(statement).fetchall()
    except psycopg.Error:
        return []


def wait(condition, seconds: float = 30.0):
    """Return the first true result of ``condition()``. Raises TimeoutError after ``seconds``."""
    until = time.monotonic() + seconds
    while True:
        with contextlib.suppress(httpx2.HTTPError):
            if answer := condition():
                return answer
        if time.monotonic() > until:
            raise TimeoutError
        time.sleep(0.02)


def quantile(values: Sequence[float], q: float) -> float:
    """Return the value that a fraction ``q`` does not exceed."""
    return sorted(values)[min(len(values) - 1, int(q * len(values)))]


def line(name: str, value: float, unit: str, remark: str) -> None:
    """Print one measurement."""
    print(f"{name:52} {value:8.1f} {unit:3}  {remark}", flush=True)


if __name__ == "__main__":
    main()
