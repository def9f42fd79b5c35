"""The commands ``polhode queue`` and ``regrade``."""

import argparse
import getpass
import sys
import time
from contextlib import suppress
from uuid import UUID

from service.cli.errors import CommandError
from service.cli.server.database import database_url, in_database, run_async
from service.settings import Settings
from service.store.queue.overview import QueueSnapshot, regrade, snapshot

EVERY_S = 1.0


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
