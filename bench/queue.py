"""What the store and the queue cost: accepting, starting, taking over, idling; a grading through them against a direct one.

Everything against a real ``polhode serve`` in a temporary folder. The goals are issue 6's, for an idle machine with two cores.
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

from exercises.catalogue import assignments
from service.cli.demo import free_port
from service.grading import grader
from service.grading.submission import Submission
from service.sandbox.select import choose
from service.store.postgres.server import running_url

PATH = "/v1/assignments/rigid-body/submissions"
SOURCE = "def euler_eqs(t, w, I):\n    return -np.cross(w, I * w) / I\n"
FAST = {"source": SOURCE, "exercises": ["2"]}
ME = {"Remote-User": "me"}
SLOW = {"source": "import time\ntime.sleep(2)\n" + SOURCE, "exercises": ["2"]}


def main() -> None:
    """Measure and print, a line each."""
    with server(workers=0) as (url, _, _):
        accepting(url, "accepting at 50/s, nobody grades")
    with server(workers=1) as (url, data, process):
        idle(process)
        starting(url, data)
        through, direct = overhead(url)
        line("exercise 2, through HTTP, queue and store", 1e3 * through, "ms", f"directly {1e3 * direct:.0f} ms")
        line("  what they add", 100 * (through / direct - 1), "%", "goal 10 %")
    with server(workers=2) as (url, data, process):
        idle(process)
        takeover(url, data)
        restart(url, data)
        accepting(url, "accepting at 50/s, two workers grade all the while")


@contextlib.contextmanager
def server(workers: int) -> Iterator[tuple[str, Path, "subprocess.Popen[bytes]"]]:
    """A server on a free port; stopped at the end."""
    port = free_port()
    with tempfile.TemporaryDirectory(prefix="polhode-bench-") as folder:
        data = Path(folder) / "data"
        own = {"POLHODE_DATA": str(data), "POLHODE_WORKERS": str(workers), "POLHODE_PERSON_HEADER": "Remote-User"}
        environment = os.environ | own
        process = subprocess.Popen([sys.executable, "-m", "service.cli", "serve", "--port", str(port)], env=environment)
        url = f"http://127.0.0.1:{port}"
        try:
            until = time.monotonic() + 60
            while time.monotonic() < until:
                with contextlib.suppress(httpx2.HTTPError):
                    if httpx2.get(f"{url}{'/readyz' if workers else '/livez'}").status_code == 200:
                        break
                time.sleep(0.1)
            time.sleep(2)
            yield url, data, process
        finally:
            process.terminate()
            process.wait(60)


def accepting(url: str, name: str, rate: float = 50.0, seconds: float = 10.0) -> None:
    """Time to a durable 202 when submissions come at an even rate, whatever the answers take."""

    async def send() -> list[float]:
        times: list[float] = []
        async with httpx2.AsyncClient(timeout=30) as client:

            async def one(k: int) -> None:
                began = time.perf_counter()
                answer = await client.post(url + PATH, json=FAST, headers={"Remote-User": f"student {k % 40}"})
                assert answer.status_code == 202
                times.append(time.perf_counter() - began)

            pending, began = [], time.perf_counter()
            for k in range(int(rate * seconds)):
                await asyncio.sleep(max(0.0, began + k / rate - time.perf_counter()))
                pending.append(asyncio.create_task(one(k)))
            await asyncio.gather(*pending)
        return times

    times = asyncio.run(send())
    line(name, 1e3 * statistics.median(times), "ms", f"p99 {1e3 * quantile(times, 0.99):.0f} ms; goal 10 and 50 on an idle machine")


def starting(url: str, data: Path, count: int = 60) -> None:
    """From the answer 202 to the beginning of the run, one submission at a time on an idle machine."""
    answered = {}
    with httpx2.Client(headers=ME, timeout=40) as client:
        for _ in range(count):
            id = client.post(url + PATH, json=FAST).json()["id"]
            answered[id] = time.time()
            wait(lambda id=id: client.get(f"{url}/v1/submissions/{id}").json()["status"] == "graded")
            time.sleep(0.05)
    began = "SELECT submission_id::text, extract(epoch FROM started_at) FROM run JOIN grading a ON a.id = grading_id"
    times = [max(0.0, float(s) - answered[id]) for id, s in query(data, began)]
    line("accepted to begun", 1e3 * statistics.median(times), "ms", f"p99 {1e3 * quantile(times, 0.99):.0f} ms; goal 5 and 20")


def overhead(url: str, count: int = 25) -> tuple[float, float]:
    """Medians of a grading over HTTP and of the same in this process, in turn."""
    grader.start(choose())
    grader.ready()
    submission, slug, through, direct = Submission(SOURCE), assignments()["rigid-body"].slug, [], []
    with httpx2.Client(headers=ME | {"Prefer": "wait=30"}, timeout=40) as client:
        for seed in range(count):
            began = time.perf_counter()
            client.post(url + PATH, json=FAST)
            through.append(time.perf_counter() - began)
            began = time.perf_counter()
            grader.grade_one(submission, slug, ["2"], seed)
            direct.append(time.perf_counter() - began)
    return statistics.median(through), statistics.median(direct)


def takeover(url: str, data: Path, count: int = 6) -> None:
    """From SIGKILL of a worker in mid-grading to the beginning of the next run, on the other worker."""
    times = []
    for _ in range(count):
        id = httpx2.post(url + PATH, json=SLOW, headers=ME, timeout=30).json()["id"]
        runs = f"SELECT worker FROM run JOIN grading a ON a.id = grading_id WHERE submission_id = '{id}' ORDER BY run.started_at"
        (worker,) = wait(lambda runs=runs: query(data, runs))[0]
        time.sleep(0.8)
        began = time.perf_counter()
        os.kill(int(worker.split("/")[1]), signal.SIGKILL)
        wait(lambda runs=runs: len(query(data, runs)) == 2)
        times.append(time.perf_counter() - began)
        wait(lambda id=id: httpx2.get(f"{url}/v1/submissions/{id}", headers=ME).json()["status"] == "graded")
    line("a dead worker's submission begun elsewhere after", statistics.median(times), "s", f"at most {max(times):.1f} s; goal 5")


def restart(url: str, data: Path, count: int = 5) -> None:
    """From SIGKILL of the database to the first submission begun after it."""
    times = []
    for _ in range(count):
        os.kill(int((data / "postgres/postmaster.pid").read_text().split("\n")[0]), signal.SIGKILL)
        began = time.perf_counter()
        accepted = wait(lambda: httpx2.post(url + PATH, json=FAST, headers=ME, timeout=30).status_code == 202)
        assert accepted
        wait(lambda: query(data, "SELECT 1 FROM run WHERE started_at > pg_postmaster_start_time()"))
        times.append(time.perf_counter() - began)
        time.sleep(2)
    line("database killed to first submission begun", statistics.median(times), "s", f"at most {max(times):.1f} s; goal 5")


def idle(process: "subprocess.Popen[bytes]", seconds: float = 20.0) -> None:
    """CPU of everything but the guests, in per cent of a core, and memory as the sum of proportional set sizes."""
    everybody = [p for p in tree(process.pid) if "bwrap" not in command(p) and "-I -S" not in command(p)]
    before = sum(ticks(p) for p in everybody)
    time.sleep(seconds)
    cpu = 100 * (sum(ticks(p) for p in everybody) - before) / os.sysconf("SC_CLK_TCK") / seconds
    line("idle: CPU without guests", cpu, "%", "goal 3 % of a core")
    line("      memory without guests", sum(proportional(p) for p in everybody) / 1024, "MB", "goal 350")


def tree(pid: int) -> list[int]:
    """A process and all below it."""
    below = [int(p) for f in Path(f"/proc/{pid}/task").glob("*/children") for p in f.read_text().split()]
    return [pid, *(q for p in below for q in tree(p))]


def command(pid: int) -> str:
    """Its command line."""
    return Path(f"/proc/{pid}/cmdline").read_text().replace("\0", " ")


def ticks(pid: int) -> int:
    """User and system time so far."""
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return int(fields[11]) + int(fields[12])


def proportional(pid: int) -> int:
    """KiB, shared pages counted in part."""
    return sum(int(w.split()[1]) for w in Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines() if w.startswith("Pss:"))


def query(data: Path, statement: str) -> list[tuple]:
    """Rows of the embedded database; none while it is out."""
    try:
        with psycopg.connect(running_url(data) or "", connect_timeout=2) as connection:
            return connection.execute(statement).fetchall()
    except psycopg.Error:
        return []


def wait(found, seconds: float = 30.0):
    """What ``found()`` gives as soon as it gives something."""
    until = time.monotonic() + seconds
    while True:
        with contextlib.suppress(httpx2.HTTPError):
            if answer := found():
                return answer
        if time.monotonic() > until:
            raise TimeoutError
        time.sleep(0.02)


def quantile(values: Sequence[float], q: float) -> float:
    """The value that a fraction ``q`` does not exceed."""
    return sorted(values)[min(len(values) - 1, int(q * len(values)))]


def line(name: str, value: float, unit: str, remark: str) -> None:
    """Print one measurement."""
    print(f"{name:52} {value:8.1f} {unit:3}  {remark}", flush=True)


if __name__ == "__main__":
    main()
