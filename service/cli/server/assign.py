"""The command ``polhode assign``: publish an assignment, set or show its deadline and other settings."""

import argparse
import getpass
from datetime import UTC, datetime

from service.cli.arguments import number
from service.cli.errors import CommandError
from service.cli.server.database import in_database
from service.store.course import assignment_settings

NONE = "none"
_LIMIT = number(int, lambda n: 1 <= n <= 10**6, detail="expected a number from 1 to 1000000, or none")


def add_assign(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    # distinguishes an option that is not given from one that removes a limit
    parser.argument_default = argparse.SUPPRESS
    parser.add_argument("slug", help="slug of the assignment")
    publish = parser.add_mutually_exclusive_group()
    publish.add_argument("--publish", dest="published", action="store_true", help="show it to students")
    publish.add_argument(
        "--draft", dest="published", action="store_false", help="hide it from students, as a new assignment"
    )
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
    draft = "" if found.published else "draft, "
    opens = f"available from {_utc(found.available_from)}, " if found.available_from else ""
    due = f"due {_utc(found.due_at)}" if found.due_at else "no deadline"
    limit = found.submission_limit or "unlimited"
    print(
        f"{arguments.slug}: {draft}{opens}{due}, grace period {found.grace_s:g} s, {limit} submissions per"
        f" student, weight {found.weight:g}"
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
