"""The commands ``polhode roster``, ``token``, ``password`` and ``unlink``: people and their credentials."""

import argparse
import getpass
import os
import shlex
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO
from uuid import UUID

from service.cli.database import database_url, report_errors, run_async
from service.formats.spreadsheet_csv import table
from service.settings import Settings

if TYPE_CHECKING:
    from service.store.database import Database

DAYS, MOST_DAYS = 200.0, 3650.0
NEW = os.O_WRONLY | os.O_CREAT | os.O_EXCL


def add(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the commands."""
    roster = commands.add_parser("roster", help="import people from a CSV file, or list the people of the course in that format")
    roster.add_argument(
        "file",
        nargs="?",
        type=Path,
        metavar="ROSTER.csv",
        help="CSV with a header: name; optional: role, full_name, email, student_id; default: list the people",
    )
    roster.add_argument(
        "--tokens",
        type=Path,
        metavar="TOKENS.csv",
        help="also give each imported person a token to log in with, in this new file, readable only by you",
    )
    roster.add_argument("--days", type=_days, help=f"with --tokens: days until the tokens expire (default {DAYS:g})")
    roster.set_defaults(run=_roster)
    token = commands.add_parser("token", help="create, list and revoke tokens")
    kinds = token.add_subparsers(dest="kind", required=True)
    give = kinds.add_parser("give", help="create a token for a person and print it; it is shown only once")
    give.add_argument("name", help="user name")
    give.add_argument("--new", action="store_true", help="add the person to the course as a student if they are not in it")
    give.add_argument("--days", type=_days, default=DAYS, help=f"days until it expires (default {DAYS:g})")
    give.add_argument(
        "--scope",
        action="append",
        choices=["submit", "read", "login"],
        help="permission of the token; repeatable; default: all three",
    )
    give.add_argument("--label", default="issued by the course", help="description in the list (default: issued by the course)")
    give.set_defaults(run=_give)
    listing = kinds.add_parser("list", help="list tokens with their first characters, newest first")
    listing.add_argument("name", nargs="?", help="user name; default: everyone")
    listing.set_defaults(run=_list)
    revoke = kinds.add_parser("revoke", help="revoke a token immediately")
    revoke.add_argument("id", nargs="?", type=UUID, help="token id from polhode token list")
    revoke.add_argument("--person", metavar="NAME", help="revoke all tokens of a person instead")
    revoke.set_defaults(run=_revoke)
    password = commands.add_parser("password", help="set a person's password, typed at a prompt or read from standard input")
    password.add_argument("name", help="user name")
    password.set_defaults(run=_password)
    unlink = commands.add_parser("unlink", help="disconnect a person from the account at the OpenID provider")
    unlink.add_argument("name", help="user name")
    unlink.set_defaults(run=_unlink)


@report_errors
def _roster(arguments: argparse.Namespace) -> int:
    if arguments.file is None and (arguments.tokens or arguments.days):
        print("polhode: --tokens and --days apply to an import: give the file ROSTER.csv too", file=sys.stderr)
        return 2
    if arguments.days and not arguments.tokens:
        print("polhode: --days applies to tokens: give the file --tokens TOKENS.csv too", file=sys.stderr)
        return 2
    return _list_people() if arguments.file is None else _import_roster(arguments)


def _list_people() -> int:
    from service.store.course import people

    with database_url(Settings()) as url:
        rows = run_async(url, people.everybody)
    print(table(people.ROSTER, ([getattr(row, column) for column in people.ROSTER] for row in rows), end="\n"), end="")
    return 0


def _import_roster(arguments: argparse.Namespace) -> int:
    from service.store.course import audit, people, tokens

    try:
        roster = people.read(arguments.file.read_bytes(), str(arguments.file))
    except people.BadRoster as error:
        print(f"polhode: {error}", file=sys.stderr)
        return 2

    async def import_roster(database: "Database", target: TextIO | None = None) -> None:
        """Import the roster in one transaction, which commits only after the token file, if any, is complete."""
        names, seconds = [entry.name for entry in roster], (arguments.days or DAYS) * tokens.DAY_S
        rows: list[tuple[str, str]] = []
        async with database.begin() as connection:
            await people.enroll(connection, roster)
            if target:
                label = "issued with the roster"
                rows = await tokens.create_all(connection, names, label=label, scopes=tokens.SCOPES, seconds=seconds)
            about = {"people": len(roster), "tokens": len(rows)}
            await audit.record(connection, getpass.getuser(), "roster", arguments.file.name, about)
            if target:
                target.write(table(("name", "token"), rows))
                target.flush()

    if arguments.tokens is None:
        with database_url(Settings()) as url:
            run_async(url, import_roster)
        print(f"imported {len(roster)} people, without tokens")
        return 0
    with os.fdopen(os.open(arguments.tokens, NEW, 0o600), "w", newline="", encoding="utf-8") as target:
        try:
            with database_url(Settings()) as url:
                run_async(url, lambda database: import_roster(database, target))
        except BaseException:
            arguments.tokens.unlink()
            raise
    print(f"imported {len(roster)} people; their tokens are in {arguments.tokens}")
    return 0


@report_errors
def _give(arguments: argparse.Namespace) -> int:
    from service.store.course import audit, people, tokens

    try:
        name = people.normalize_name(arguments.name)
    except people.InvalidName as error:
        print(f"polhode: {error}", file=sys.stderr)
        return 2

    async def create(database: "Database") -> str | None:
        seconds, scopes = arguments.days * tokens.DAY_S, arguments.scope or tokens.SCOPES
        async with database.begin() as connection:
            if not arguments.new and not await people.is_member(connection, name):
                return None
            await audit.record(connection, getpass.getuser(), "give token", name, {"scopes": list(scopes)})
            return await tokens.create(connection, name, label=arguments.label, scopes=scopes, seconds=seconds)

    with database_url(Settings()) as url:
        token = run_async(url, create)
    if token is None:
        print(
            f"polhode: no person named {name}: import a roster with polhode roster, or add this person with "
            f"polhode token give --new {shlex.quote(name)}",
            file=sys.stderr,
        )
        return 2
    print(token)
    return 0


@report_errors
def _list(arguments: argparse.Namespace) -> int:
    from service.store.course import tokens

    with database_url(Settings()) as url:
        rows = run_async(url, lambda database: tokens.all_of(database, arguments.name))
    print("\n".join(_lines(rows)) or "no tokens")
    return 0


@report_errors
def _revoke(arguments: argparse.Namespace) -> int:
    from service.store.course import audit, tokens

    if (arguments.id is None) == (arguments.person is None):
        print("polhode: give exactly one of an id and --person NAME", file=sys.stderr)
        return 2

    async def revoke(database: "Database") -> int:
        async with database.begin() as connection:
            count = await tokens.revoke(connection, id=arguments.id, person=arguments.person)
            subject = str(arguments.id or arguments.person)
            await audit.record(connection, getpass.getuser(), "revoke token", subject, {"count": count})
        return count

    with database_url(Settings()) as url:
        count = run_async(url, revoke)
    print(f"revoked {count} token(s)")
    return 0 if count else 1


def _lines(rows: Any) -> Iterator[str]:
    for row in rows:
        state = "revoked" if row.revoked_at else "expired" if row.expired else f"valid until {row.expires_at:%Y-%m-%d}"
        used = f"used {row.used_at:%Y-%m-%d}" if row.used_at else "never used"
        yield f"{row.id}  {row.prefix}…  {row.name}  {','.join(row.scopes)}  {state}, {used}  {row.label}"


def _days(text: str) -> float:
    if not 0 < (days := float(text)) <= MOST_DAYS:
        raise argparse.ArgumentTypeError(f"expected more than 0 and at most {MOST_DAYS:g} days, got {text}")
    return days


@report_errors
def _password(arguments: argparse.Namespace) -> int:
    from service.auth import passwords
    from service.store.course import credentials, people

    try:
        name = people.normalize_name(arguments.name)
        hashed = passwords.hash_password(passwords.normalize(_read_password(name), name))
    except (people.InvalidName, passwords.InvalidPassword) as error:
        print(f"polhode: {error}", file=sys.stderr)
        return 2

    async def store(database: "Database") -> bool:
        async with database.begin() as connection:
            return await credentials.set_password(connection, name, hashed, by=getpass.getuser())

    with database_url(Settings()) as url:
        known = run_async(url, store)
    if not known:
        print(f"polhode: no person named {name}: add people with polhode roster or polhode token give --new", file=sys.stderr)
        return 1
    print(f"the password of {name} is set; all browser sessions of {name} are logged out")
    return 0


@report_errors
def _unlink(arguments: argparse.Namespace) -> int:
    from service.store.course import credentials

    async def unlink(database: "Database") -> bool:
        async with database.begin() as connection:
            return await credentials.unlink(connection, arguments.name, by=getpass.getuser())

    with database_url(Settings()) as url:
        known = run_async(url, unlink)
    if not known:
        print(f"polhode: {arguments.name} has no linked OpenID account", file=sys.stderr)
        return 1
    print(f"the OpenID account of {arguments.name} is unlinked")
    return 0


def _read_password(name: str) -> str:
    """Return the password typed twice at a terminal, or the first line of standard input."""
    from service.auth import passwords

    if not sys.stdin.isatty():
        return sys.stdin.readline().rstrip("\r\n")
    password = getpass.getpass(f"New password of {name}: ")
    if password != getpass.getpass("Repeat new password: "):
        raise passwords.InvalidPassword("the passwords do not match")
    return password
