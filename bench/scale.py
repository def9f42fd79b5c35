"""Throughput against the number of worker machines that share one PostgreSQL, and where the database becomes
the limit.

Each machine is a network namespace with an address of its own, and reaches the database over TCP with a
password. Its workers are polhode's, but grading is a wait of the measured time that returns a recorded report
and arrays of its size: eight machines then fit on a machine with two cores. The database may use a share of
one core (``--quota``, cgroups of version 1). Needs root. ``python -m bench.scale`` prints one row for each
number of machines.
"""

import argparse
import asyncio
import os
import secrets
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import uuid
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import psycopg

from bench.stand_ins import SOURCE, be_workers, record
from exercises.authoring.assignments.catalogue import assignments
from service.cli.server.demo import free_port
from service.grading.submission import Submission
from service.store.database import Database
from service.store.postgres.os_user import as_server, own
from service.store.postgres.server import find_programs
from service.store.schema import migrate
from service.store.submissions.accepting import accept, register
from service.store.submissions.records import NewSubmission

CGROUP = Path("/sys/fs/cgroup/cpu")
PERIOD_US, TICK = 100_000, os.sysconf("SC_CLK_TCK")
PERSONS = 500


def main() -> None:
    """Measure each number of machines on a new database, or be the workers of one machine."""
    parser = argparse.ArgumentParser(prog="bench.scale", description=__doc__)
    parser.add_argument("--machines", type=int, nargs="+", default=[1, 2, 4, 8])
    parser.add_argument("--workers", type=int, default=4, help="of each machine")
    parser.add_argument(
        "--grading",
        type=float,
        default=0.3,
        metavar="SECONDS",
        help="time of one grading; 0: the store alone",
    )
    parser.add_argument(
        "--seconds", type=float, default=12.0, help="length of each measurement at the ideal rate"
    )
    parser.add_argument(
        "--quota", type=float, metavar="CORES", help="share of a core that the database may use"
    )
    parser.add_argument("--be-workers", type=Path, metavar="FILE", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.be_workers:
        be_workers(given.be_workers, lambda submission, seed: given.grading)
        return
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # ends machines and database too
    with tempfile.TemporaryDirectory(prefix="scale-", ignore_cleanup_errors=True) as name:
        folder = Path(name)
        folder.chmod(0o755)
        record(folder / "recorded")
        print(
            f"{given.workers} workers for each machine, {given.grading:g} s a grading, database quota"
            f" {given.quota or 'none'}"
        )
        print("machines  gradings/s  ideal  database CPU ms each  database cores  connections  load")
        for number in given.machines:
            measure(folder / str(number), folder / "recorded", number, given)


def measure(folder: Path, recorded: Path, number: int, given: argparse.Namespace) -> None:
    """Fill a new database with waiting submissions, let machines grade them, and print a row."""
    folder.mkdir(mode=0o755)
    workers = number * given.workers
    ideal = workers / given.grading if given.grading else float("nan")
    waiting = int(given.seconds * (ideal if given.grading else 60))
    with postgres(folder, number, given.quota) as (addresses, process):
        url = addresses[0]
        migrate(url)
        asyncio.run(fill(url, waiting))
        with machines(addresses[1:], recorded, given), psycopg.connect(url, autocommit=True) as connection:
            wait_for(connection, 4 * workers if given.grading else 20)  # all workers have begun
            before, began, spent = finished(connection), time.monotonic(), cpu_s(process)
            wait_for(connection, waiting - 2 * workers if given.grading else waiting)
            after, took, spent = finished(connection), time.monotonic() - began, cpu_s(process) - spent
            open_now = connection.execute(
                "SELECT count(*) FROM pg_stat_activity WHERE backend_type = 'client backend'"
            ).fetchone()
            wait_for(connection, waiting)
            (doubled,) = connection.execute(
                "SELECT count(*) - count(DISTINCT grading_id) FROM run"
            ).fetchone() or (0,)
        rate = (after - before) / took
        each = 1000 * spent / (after - before)
        used = f"{each:20.1f}  {spent / took:14.2f}  {open_now[0] - 1:11d}  {os.getloadavg()[0]:4.1f}"
        row = f"{number:8d}  {rate:10.1f}  {ideal:5.1f}  {used}"
        print(row + (f"  {doubled} repeated runs" if doubled else ""), flush=True)


async def fill(url: str, number: int) -> None:
    """Store submissions of many persons, all waiting."""
    each = [
        NewSubmission(
            uuid.uuid4(), "rigid-body", f"s{k % PERSONS:03}", Submission(SOURCE, exercises=["2"]), k
        )
        for k in range(number)
    ]
    async with Database(url, "bench", connections=8) as database:
        await register(database, assignments().values())
        for start in range(0, number, 8):
            await asyncio.gather(*(accept(database, one) for one in each[start : start + 8]))


def finished(connection: psycopg.Connection) -> int:
    """Return the number of results."""
    row = connection.execute("SELECT count(*) FROM result").fetchone()
    return int(row[0]) if row else 0


def wait_for(connection: psycopg.Connection, number: int) -> None:
    """Wait until there are so many results. Raises TimeoutError after five minutes."""
    until = time.monotonic() + 300
    while finished(connection) < number:
        if time.monotonic() > until:
            raise TimeoutError(f"{finished(connection)} of {number} results after five minutes")
        time.sleep(0.05)


@contextmanager
def postgres(folder: Path, number: int, quota: float | None) -> Iterator[tuple[list[str], int]]:
    """Run a PostgreSQL on TCP; yield its address on loopback and on the cable of each machine, and its
    process id.
    """
    programs, data, password, port = find_programs(), folder / "cluster", secrets.token_hex(12), free_port()
    (folder / "password").write_text(password)
    data.mkdir(mode=0o700)
    own(data)
    view = as_server(programs, data, folder)
    own(folder)
    options = [
        "-U",
        "polhode",
        "--auth=scram-sha-256",
        f"--pwfile={folder / 'password'}",
        "--encoding=UTF8",
        "--locale=C",
    ]
    subprocess.run(
        [*view, str(programs / "initdb"), "-D", str(data), *options], check=True, capture_output=True
    )
    (data / "pg_hba.conf").write_text("host all all all scram-sha-256\n")
    hosts = ["127.0.0.1", *(cable(k)[1] for k in range(number))]
    with namespaces(number):
        settings = {
            "listen_addresses": ",".join(hosts),
            "port": port,
            "unix_socket_directories": "",
            "max_connections": 400,
        }
        named = [part for name, value in settings.items() for part in ("-c", f"{name}={value}")]
        with (folder / "log").open("wb") as log:
            process = subprocess.Popen(
                [*view, str(programs / "postgres"), "-D", str(data), *named], stdout=log, stderr=log
            )
        urls = [f"postgresql://polhode:{password}@{host}:{port}/postgres?sslmode=disable" for host in hosts]
        group = CGROUP / f"polhode-scale-{os.getpid()}"
        try:
            for _ in range(200):
                try:
                    psycopg.connect(urls[0], connect_timeout=2).close()
                    break
                except psycopg.OperationalError:
                    time.sleep(0.1)
            main = int((data / "postmaster.pid").read_text().split("\n")[0])
            if quota:
                group.mkdir()
                (group / "cpu.cfs_period_us").write_text(str(PERIOD_US))
                (group / "cpu.cfs_quota_us").write_text(str(int(quota * PERIOD_US)))
                for one in (main, *children(main)):
                    with suppress(ProcessLookupError):  # a connection that has just been closed
                        (group / "cgroup.procs").write_text(str(one))
            yield urls, main
        finally:
            # its parent cannot signal it
            os.kill(int((data / "postmaster.pid").read_text().split("\n")[0]), signal.SIGINT)
            process.wait(60)
            if group.exists():
                group.rmdir()


def children(process: int) -> list[int]:
    """Return the child processes of a process."""
    return [int(one) for one in Path(f"/proc/{process}/task/{process}/children").read_text().split()]


def cpu_s(process: int) -> float:
    """Return the CPU time in s of a PostgreSQL: of its main process, of children that ended, and of those
    that run.
    """
    main = _times(process)
    return (sum(main) + sum(sum(_times(one)[:2]) for one in children(process))) / TICK


def _times(process: int) -> list[int]:
    """Return utime, stime, cutime and cstime of a process in ticks; zeros if it has ended."""
    try:
        return [int(n) for n in Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[11:15]]
    except OSError:
        return [0, 0, 0, 0]


def cable(number: int) -> tuple[str, str, str]:
    """Return the name of a machine, the database's address on the cable to it, and the machine's own."""
    subnet = f"10.{100 + os.getpid() % 100}.{number}"
    return f"scale{os.getpid() % 100000}m{number}", f"{subnet}.1", f"{subnet}.2"


@contextmanager
def namespaces(number: int) -> Iterator[None]:
    """Make a network namespace with a cable for each machine."""
    try:
        for k in range(number):
            name, ours, theirs = cable(k)
            wire = name.replace("scale", "sc")
            for words in (
                f"netns add {name}",
                f"link add {wire} type veth peer name eth0 netns {name}",
                f"addr add {ours}/24 dev {wire}",
                f"link set {wire} up",
                f"-n {name} addr add {theirs}/24 dev eth0",
                f"-n {name} link set eth0 up",
                f"-n {name} link set lo up",
            ):
                subprocess.run(["ip", *words.split()], check=True, capture_output=True)
        yield
    finally:
        for k in range(number):
            subprocess.run(["ip", "netns", "delete", cable(k)[0]], check=False, capture_output=True)


@contextmanager
def machines(addresses: list[str], recorded: Path, given: argparse.Namespace) -> Iterator[None]:
    """Run the workers of each machine."""
    running = []
    clean = {
        k: v for k, v in os.environ.items() if not k.startswith("POLHODE_") and k != "PYTHONDONTWRITEBYTECODE"
    }
    for k, url in enumerate(addresses):
        environment = clean | {
            "POLHODE_DATABASE_URL": url,
            "POLHODE_WORKERS": str(given.workers),
            "OMP_NUM_THREADS": "1",
        }
        command = [
            sys.executable,
            "-m",
            "bench.scale",
            "--be-workers",
            str(recorded),
            "--grading",
            str(given.grading),
        ]
        inside = ["ip", "netns", "exec", cable(k)[0], *command]
        running.append(subprocess.Popen(inside, env=environment, stderr=subprocess.DEVNULL))
    try:
        yield
    finally:
        for one in running:
            one.terminate()
        for one in running:
            one.wait(60)


if __name__ == "__main__":
    if os.geteuid() != 0 or shutil.which("ip") is None:
        sys.exit("bench.scale: run it as root, on a machine with the program ip")
    main()
