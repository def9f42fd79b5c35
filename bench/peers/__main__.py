"""Compare verdicts and times with other autograders (about a quarter of an hour; ``--quick``: one round).

The exit code is 0 whether or not the goals are met, and 2 if a tool rejects a correct submission or accepts a
sign error: then nothing is timed.
"""

import argparse
import os
import platform
import shutil
import signal
import sys
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

from bench.peers import goals, table
from bench.peers.check50 import Check50
from bench.peers.environment import NotInstalled, python_for, versions
from bench.peers.gradescope import Gradescope
from bench.peers.judging import answers, sound, verdicts
from bench.peers.nbgrader import Nbgrader
from bench.peers.otter import Otter
from bench.peers.peer import Peer, Workspace, clean_environment
from bench.peers.polhode import Polhode
from bench.peers.rounds import cases, measure
from bench.peers.submissions import SAMPLES, submissions
from bench.peers.warm import Warm
from bench.queue import server

PEERS = (Otter, Nbgrader, Check50, Gradescope)
AGAINST = (("otter run", 1 / 50), ("nbgrader autograde", 1 / 50))
BATCH = 10
COMPARED = ("otter-grader", "nbgrader", "check50", "gradescope-utils", "numpy", "scipy", "matplotlib")
ROOT = Path(__file__).parents[2]


def main() -> int:
    """Measure and print the tables."""
    parser = argparse.ArgumentParser(prog="bench.peers", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="measure one round")
    parser.add_argument("--rounds", type=int, default=3, help="rounds of measurements (default 3)")
    parser.add_argument(
        "--cache",
        type=Path,
        default=ROOT / ".bench",
        metavar="DIR",
        help="folder for the environments (default .bench)",
    )
    arguments = parser.parse_args()
    cache = arguments.cache.resolve()
    for how in (signal.SIGINT, signal.SIGTERM):  # a shell may start background jobs with SIGINT ignored
        signal.signal(how, signal.default_int_handler)
    own, sent = _polhode(cache), submissions(BATCH)
    tools = [own, *_peers(cache)]
    print(about(), flush=True)
    given = verdicts(tools, sent)
    print(f"\n{table.verdicts(list(SAMPLES), given)}\n", flush=True)
    if wrong := [t.name for t in tools if not sound(given[t.name]) and (t is own or answers(given[t.name]))]:
        print(
            f"broken: {', '.join(wrong)} does not distinguish a correct submission from a sign error",
            file=sys.stderr,
        )
        return 2
    with server(workers=os.cpu_count() or 1) as (url, _, process):
        warm = Warm(url, process.pid, sent)
        warm.grade_forms()  # until both workers have prepared their statements
        found = cases([t for t in tools if answers(given[t.name])], warm, BATCH)
        rows = measure(found, 1 if arguments.quick else arguments.rounds)
    print(f"{table.times(rows)}\n")
    print(*goals.goals(rows, AGAINST, BATCH), *goals.limits(rows), sep="\n")
    print(f"load at the end {os.getloadavg()[0]:.1f}")
    return 0


def about() -> str:
    """Return the machine and the versions of the compared tools."""
    models = [
        line.split(":")[1].strip()
        for line in Path("/proc/cpuinfo").read_text().splitlines()
        if line.startswith("model name")
    ]
    machine = (
        f"{(models or [platform.machine()])[0]}, {os.cpu_count()} cores, Python {platform.python_version()}"
    )
    pinned = {name: version for kind in PEERS for name, version in versions(kind.package).items()}
    compared = ", ".join(f"{name} {pinned[name]}" for name in COMPARED)
    return f"{datetime.now(UTC):%Y-%m-%d %H:%M} UTC, {machine}, load {os.getloadavg()[0]:.1f}\n{compared}"


def _polhode(cache: Path) -> Peer:
    kept = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    return Polhode(
        Workspace(
            Path(sys.executable),
            _empty(cache / "work/polhode"),
            kept | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
        )
    )


def _peers(cache: Path) -> Sequence[Peer]:
    """Return the peers that can be installed."""
    found: list[Peer] = []
    for kind in PEERS:
        try:
            python = python_for(kind.package, cache)
        except NotInstalled as error:
            print(f"{kind.name}: not installed: {error}")
            continue
        home = _empty(cache / "work" / kind.package / "home").parent
        found.append(kind(Workspace(python, home, clean_environment(home / "home", python.parent))))
    return found


def _empty(folder: Path) -> Path:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder


if __name__ == "__main__":
    sys.exit(main())
