"""polhode queue, regrade and assign: look at the work, ask for it again, set its rules."""

import argparse
import getpass
import sys
import time
from datetime import datetime
from typing import TYPE_CHECKING, TypeVar
from uuid import UUID

from service.cli.database import database_url, report_errors, run_async
from service.settings import Settings

if TYPE_CHECKING:
    from service.store.queue_overview import QueueSnapshot

T = TypeVar("T")
EVERY_S = 1.0


def add(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the commands."""
    queue = commands.add_parser("queue", help="who waits and who works; on a terminal anew every second")
    queue.add_argument("--once", action="store_true", help="print it once")
    queue.set_defaults(run=_queue)
    regrade = commands.add_parser("regrade", help="grade submissions again, behind everybody who waits for a first result")
    regrade.add_argument("ids", nargs="*", type=UUID, metavar="ID")
    regrade.add_argument("--faults", action="store_true", help="instead: those that have no report, only a fault of ours")
    regrade.add_argument("--all", action="store_true", help="instead: every one that is not being graded")
    regrade.set_defaults(run=_regrade)
    assign = commands.add_parser("assign", help="until when and how often an assignment may be submitted; sets all three")
    assign.add_argument("slug")
    assign.add_argument("--due", type=_moment, help="such as 2026-12-01T12:00+01:00; default: no deadline")
    assign.add_argument("--grace", type=_seconds, default=0.0, metavar="SECONDS", help="taken so long after it, marked late")
    assign.add_argument("--most", type=_count, metavar="N", help="submissions per person; default: any number")
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
    """The queue as a table for a terminal."""
    lines = [f"{w.n:6} {w.kind} waiting, the first for {w.waited_s:.1f} s" for w in queue.waiting] or ["nothing waits"]
    lines += ["", f"{'worker':28} {'since':>8} {'heard':>7}  {'what':24} whose"]
    for g in queue.going:
        what = f"{g.phase} {g.scene}/{g.scenes}" if g.scenes else g.phase
        lines.append(f"{g.worker:28} {g.running_s:6.1f} s {g.silent_s:5.1f} s  {what:24} {g.person} {g.submission} ({g.kind})")
    busy = {g.worker for g in queue.going}
    for w in queue.workers:
        if w.name not in busy:
            lines.append(
                f"{w.name:28} {'':8} {w.silent_s:5.1f} s  {'refuses: ' + w.unavailable_reason if w.unavailable_reason else 'idle'}"
            )
    lines += [f"fault   {f.submission}  {f.person}  {f.finished_at:%Y-%m-%d %H:%M}  {f.fault}" for f in queue.faults]
    return "\n".join(lines)


@report_errors
def _regrade(arguments: argparse.Namespace) -> int:
    from service.store.queue_overview import regrade

    which = "all" if arguments.all else "faults" if arguments.faults else arguments.ids
    if bool(arguments.ids) + arguments.all + arguments.faults != 1:
        print("polhode: which ones? Give either ids, --faults or --all", file=sys.stderr)
        return 2
    with database_url(Settings()) as url:
        count = run_async(url, lambda database: regrade(database, which, getpass.getuser()))
    print(f"queued again: {count}")
    if arguments.ids and count < len(set(arguments.ids)):
        print("polhode: the others do not exist or are being graded", file=sys.stderr)
        return 2
    return 0


@report_errors
def _assign(arguments: argparse.Namespace) -> int:
    from service.store.queue_overview import Rules, set_rules

    with database_url(Settings()) as url:
        rules = Rules(arguments.due, arguments.grace, arguments.most)
        known = run_async(url, lambda database: set_rules(database, arguments.slug, rules, getpass.getuser()))
    if not known:
        print(f"polhode: the database has no assignment {arguments.slug}", file=sys.stderr)
        return 2
    due = f"until {arguments.due.isoformat()} and {arguments.grace:g} s" if arguments.due else "without a deadline"
    print(f"{arguments.slug}: {due}, {arguments.most or 'any number of'} submissions a person")
    return 0


def _moment(text: str) -> datetime:
    try:
        moment = datetime.fromisoformat(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text} is no time such as 2026-12-01T12:00+01:00") from None
    if moment.tzinfo is None:
        raise argparse.ArgumentTypeError("give the time zone too, such as +01:00 or Z")
    if not 2000 <= moment.year < 3000:
        raise argparse.ArgumentTypeError(f"the year {moment.year} is out of range")
    return moment


def _seconds(text: str) -> float:
    if not 0 <= (seconds := float(text)) <= 1e7:
        raise argparse.ArgumentTypeError("between 0 and 10000000 seconds")
    return seconds


def _count(text: str) -> int:
    if not 1 <= (count := int(text)) <= 10**6:
        raise argparse.ArgumentTypeError("between 1 and 1000000")
    return count
