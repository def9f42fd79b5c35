"""The commands ``polhode queue``, ``regrade`` and ``assign``."""

import argparse
import getpass
import sys
import time
from contextlib import suppress
from datetime import UTC, datetime
from uuid import UUID

from service.cli.arguments import number
from service.cli.database import database_url, in_database, run_async
from service.cli.errors import CommandError
from service.settings import Settings
from service.store.queue_overview import QueueSnapshot, change_rules, regrade, snapshot

EVERY_S = 1.0
NONE, RULES = "none", ("due_at", "grace_s", "submission_limit", "weight")
_LIMIT = number(int, lambda n: 1 <= n <= 10**6, detail="expected a number from 1 to 1000000, or none")


def add_queue(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("--once", action="store_true", help="print the queue once and exit")
    parser.set_defaults(run=_queue)


def add_regrade(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("ids", nargs="*", type=UUID, metavar="ID", help="submissions to grade again")
    parser.add_argument(
        "--faults",
        action="store_true",
        help="select all submissions without a report because of a system fault",
    )
    parser.add_argument("--all", action="store_true", help="select all submissions that are not being graded")
    parser.set_defaults(run=_regrade)


def add_assign(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    # distinguishes an option that is not given from one that removes a limit
    parser.argument_default = argparse.SUPPRESS
    parser.add_argument("slug", help="slug of the assignment")
    parser.add_argument(
        "--due",
        dest="due_at",
        type=_moment,
        metavar="TIME",
        help="deadline, such as 2026-12-01T12:00+01:00; none: no deadline",
    )
    parser.add_argument(
        "--grace",
        dest="grace_s",
        type=number(float, lambda s: 0 <= s <= 1e7, detail="expected 0 to 10000000 seconds"),
        metavar="SECONDS",
        help="accept submissions this long after the deadline, marked late; 0: no grace period",
    )
    parser.add_argument(
        "--most",
        dest="submission_limit",
        type=_limit,
        metavar="N",
        help="submissions per student; none: unlimited",
    )
    parser.add_argument(
        "--weight",
        type=number(float, lambda w: 0 <= w <= 1000, detail="expected 0 to 1000"),
        metavar="WEIGHT",
        help="weight in the course, 0 to 1000; 1 unless set",
    )
    parser.set_defaults(run=_assign)


def _queue(arguments: argparse.Namespace) -> None:
    live = sys.stdout.isatty() and not arguments.once
    with database_url(Settings()) as url, suppress(KeyboardInterrupt):
        while True:
            print(("\x1b[2J\x1b[H" if live else "") + show(run_async(url, snapshot)), flush=True)
            if not live:
                return
            time.sleep(EVERY_S)


def show(queue: QueueSnapshot) -> str:
    """Return the queue as a table for a terminal."""
    lines = [f"{w.n:6} {w.kind} waiting, the first for {w.waited_s:.1f} s" for w in queue.waiting] or [
        "the queue is empty"
    ]
    lines += ["", f"{'worker':28} {'running':>8} {'last seen':>9}  {'step':24} submission"]
    for g in queue.going:
        step = f"{g.phase} {g.scene}/{g.scenes}" if g.scenes else g.phase
        lines.append(
            f"{g.worker:28} {g.running_s:6.1f} s {g.silent_s:7.1f} s  {step:24} {g.person} {g.submission}"
            f" ({g.kind})"
        )
    busy = {g.worker for g in queue.going}
    for w in queue.workers:
        if w.name not in busy:
            state = f"not grading: {w.unavailable_reason}" if w.unavailable_reason else "idle"
            lines.append(f"{w.name:28} {'':8} {w.silent_s:7.1f} s  {state}")
    lines += [
        f"fault   {f.submission}  {f.person}  {f.finished_at:%Y-%m-%d %H:%M}  {f.fault}" for f in queue.faults
    ]
    return "\n".join(lines)


def _regrade(arguments: argparse.Namespace) -> None:
    which = "all" if arguments.all else "faults" if arguments.faults else arguments.ids
    if bool(arguments.ids) + arguments.all + arguments.faults != 1:
        raise CommandError("give exactly one of ids, --faults and --all")
    count = in_database(lambda database: regrade(database, which, getpass.getuser()))
    print(f"queued for regrading: {count}")
    if arguments.ids and count < (wanted := len(set(arguments.ids))):
        raise CommandError(
            f"{wanted - count} of {wanted} submissions were not queued: they do not exist or are being graded"
        )


def _assign(arguments: argparse.Namespace) -> None:
    changes = {name: value for name, value in vars(arguments).items() if name in RULES}
    rules = in_database(lambda database: change_rules(database, arguments.slug, changes, getpass.getuser()))
    if rules is None:
        raise CommandError(
            f"the database has no assignment {arguments.slug}: polhode assignments lists the known ones"
        )
    due = f"due {rules.due_at.astimezone(UTC).isoformat()}" if rules.due_at else "no deadline"
    limit = rules.submission_limit or "unlimited"
    print(
        f"{arguments.slug}: {due}, grace period {rules.grace_s:g} s, {limit} submissions per student, weight"
        f" {rules.weight:g}"
    )


def _moment(text: str) -> datetime | None:
    if text == NONE:
        return None
    try:
        moment = datetime.fromisoformat(text)
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"expected a time such as 2026-12-01T12:00+01:00, or none, got {text}"
        ) from None
    if moment.tzinfo is None:
        raise argparse.ArgumentTypeError(f"{text} has no time zone: append one such as +01:00 or Z")
    if not 2000 <= moment.year < 3000:
        raise argparse.ArgumentTypeError(f"the year {moment.year} is out of range")
    return moment


def _limit(text: str) -> int | None:
    return None if text == NONE else _LIMIT(text)
