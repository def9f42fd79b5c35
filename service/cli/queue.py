"""The commands ``polhode queue``, ``regrade`` and ``assign``."""

import argparse
import getpass
import sys
import time
from datetime import UTC, datetime
from typing import TYPE_CHECKING
from uuid import UUID

from service.cli.database import database_url, report_errors, run_async
from service.settings import Settings

if TYPE_CHECKING:
    from service.store.queue_overview import QueueSnapshot

EVERY_S = 1.0
NONE, RULES = "none", ("due_at", "grace_s", "submission_limit", "weight")


def add(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the commands."""
    queue = commands.add_parser("queue", help="show waiting and running gradings (refreshes every second on a terminal)")
    queue.add_argument("--once", action="store_true", help="print the queue once and exit")
    queue.set_defaults(run=_queue)
    regrade = commands.add_parser("regrade", help="grade submissions again, after all first gradings; results apply immediately")
    regrade.add_argument("ids", nargs="*", type=UUID, metavar="ID", help="submissions to grade again")
    regrade.add_argument("--faults", action="store_true", help="select all submissions without a report because of a system fault")
    regrade.add_argument("--all", action="store_true", help="select all submissions that are not being graded")
    regrade.set_defaults(run=_regrade)
    assign = commands.add_parser(
        "assign",
        help="set or show deadline, grace period, submission limit and weight; options not given stay unchanged",
        argument_default=argparse.SUPPRESS,  # distinguishes an option that is not given from one that removes a limit
    )
    assign.add_argument("slug", help="slug of the assignment")
    assign.add_argument(
        "--due", dest="due_at", type=_moment, metavar="TIME", help="deadline, such as 2026-12-01T12:00+01:00; none: no deadline"
    )
    assign.add_argument(
        "--grace",
        dest="grace_s",
        type=_seconds,
        metavar="SECONDS",
        help="accept submissions this long after the deadline, marked late; 0: no grace period",
    )
    assign.add_argument(
        "--most", dest="submission_limit", type=_count, metavar="N", help="submissions per student; none: unlimited"
    )
    assign.add_argument("--weight", type=_weight, metavar="WEIGHT", help="weight in the course, 0 to 1000; 1 unless set")
    assign.set_defaults(run=_assign)


@report_errors
def _queue(arguments: argparse.Namespace) -> int:
    from service.store.queue_overview import snapshot

    live = sys.stdout.isatty() and not arguments.once
    with database_url(Settings()) as url:
        try:
            while True:
                print(("\x1b[2J\x1b[H" if live else "") + show(run_async(url, snapshot)), flush=True)
                if not live:
                    return 0
                time.sleep(EVERY_S)
        except KeyboardInterrupt:
            return 0


def show(queue: "QueueSnapshot") -> str:
    """Return the queue as a table for a terminal."""
    lines = [f"{w.n:6} {w.kind} waiting, the first for {w.waited_s:.1f} s" for w in queue.waiting] or ["the queue is empty"]
    lines += ["", f"{'worker':28} {'running':>8} {'last seen':>9}  {'step':24} submission"]
    for g in queue.going:
        step = f"{g.phase} {g.scene}/{g.scenes}" if g.scenes else g.phase
        lines.append(f"{g.worker:28} {g.running_s:6.1f} s {g.silent_s:7.1f} s  {step:24} {g.person} {g.submission} ({g.kind})")
    busy = {g.worker for g in queue.going}
    for w in queue.workers:
        if w.name not in busy:
            state = f"not grading: {w.unavailable_reason}" if w.unavailable_reason else "idle"
            lines.append(f"{w.name:28} {'':8} {w.silent_s:7.1f} s  {state}")
    lines += [f"fault   {f.submission}  {f.person}  {f.finished_at:%Y-%m-%d %H:%M}  {f.fault}" for f in queue.faults]
    return "\n".join(lines)


@report_errors
def _regrade(arguments: argparse.Namespace) -> int:
    from service.store.queue_overview import regrade

    which = "all" if arguments.all else "faults" if arguments.faults else arguments.ids
    if bool(arguments.ids) + arguments.all + arguments.faults != 1:
        print("polhode: give exactly one of ids, --faults and --all", file=sys.stderr)
        return 2
    with database_url(Settings()) as url:
        count = run_async(url, lambda database: regrade(database, which, getpass.getuser()))
    print(f"queued for regrading: {count}")
    if arguments.ids and count < (wanted := len(set(arguments.ids))):
        text = f"polhode: {wanted - count} of {wanted} submissions were not queued: they do not exist or are being graded"
        print(text, file=sys.stderr)
        return 2
    return 0


@report_errors
def _assign(arguments: argparse.Namespace) -> int:
    from service.store.queue_overview import change_rules

    changes = {name: value for name, value in vars(arguments).items() if name in RULES}
    with database_url(Settings()) as url:
        rules = run_async(url, lambda database: change_rules(database, arguments.slug, changes, getpass.getuser()))
    if rules is None:
        print(
            f"polhode: the database has no assignment {arguments.slug}: polhode assignments lists the known ones", file=sys.stderr
        )
        return 2
    due = f"due {rules.due_at.astimezone(UTC).isoformat()}" if rules.due_at else "no deadline"
    limit = rules.submission_limit or "unlimited"
    print(f"{arguments.slug}: {due}, grace period {rules.grace_s:g} s, {limit} submissions per student, weight {rules.weight:g}")
    return 0


def _moment(text: str) -> datetime | None:
    if text == NONE:
        return None
    try:
        moment = datetime.fromisoformat(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"expected a time such as 2026-12-01T12:00+01:00, or none, got {text}") from None
    if moment.tzinfo is None:
        raise argparse.ArgumentTypeError(f"{text} has no time zone: append one such as +01:00 or Z")
    if not 2000 <= moment.year < 3000:
        raise argparse.ArgumentTypeError(f"the year {moment.year} is out of range")
    return moment


def _seconds(text: str) -> float:
    if not 0 <= (seconds := float(text)) <= 1e7:
        raise argparse.ArgumentTypeError(f"expected 0 to 10000000 seconds, got {text}")
    return seconds


def _weight(text: str) -> float:
    if not 0 <= (weight := float(text)) <= 1000:
        raise argparse.ArgumentTypeError(f"expected 0 to 1000, got {text}")
    return weight


def _count(text: str) -> int | None:
    if text == NONE:
        return None
    if not 1 <= (count := int(text)) <= 10**6:
        raise argparse.ArgumentTypeError(f"expected a number from 1 to 1000000, or none, got {text}")
    return count
