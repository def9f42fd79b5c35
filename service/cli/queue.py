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
from service.store.course import assignment_settings
from service.store.queue.overview import QueueSnapshot, regrade, snapshot

EVERY_S = 1.0
NONE = "none"
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
        "--available-from",
        type=_moment,
        metavar="TIME",
        help="show students the title only before this time; none: available now",
    )
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
    given = vars(arguments)
    changes = {name: given[name] for name in assignment_settings.NAMES if name in given}
    found = in_database(
        lambda database: assignment_settings.change(database, arguments.slug, changes, getpass.getuser())
    )
    if found is None:
        raise CommandError(
            f"the database has no assignment {arguments.slug}: polhode assignments lists the known ones"
        )
    opens = f"available from {_utc(found.available_from)}, " if found.available_from else ""
    due = f"due {_utc(found.due_at)}" if found.due_at else "no deadline"
    limit = found.submission_limit or "unlimited"
    print(
        f"{arguments.slug}: {opens}{due}, grace period {found.grace_s:g} s, {limit} submissions per student,"
        f" weight {found.weight:g}"
    )


def _utc(moment: datetime) -> str:
    return moment.astimezone(UTC).isoformat()


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
