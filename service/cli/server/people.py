"""The commands ``polhode roster``, ``token``, ``password`` and ``unlink``: people and their credentials."""

import argparse
import getpass
import os
import shlex
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TextIO
from uuid import UUID

from service.auth import passwords
from service.cli.arguments import number
from service.cli.errors import CommandError
from service.cli.server.database import in_database, in_transaction
from service.formats.spreadsheet_csv import table
from service.store.course import audit
from service.store.database import Connection
from service.store.people import credentials, people, tokens
from service.store.people.roster.columns import FIELDS
from service.store.people.roster.importing import Plan, carry_out, compare
from service.store.people.roster.problems import shortened
from service.store.people.roster.reading import Choices, Roster, read
from service.store.people.roster.text import ENCODINGS

DAYS, MOST_DAYS = tokens.TERM_DAYS, 3650.0
NEW = os.O_WRONLY | os.O_CREAT | os.O_EXCL
_days = number(
    float, lambda days: 0 < days <= MOST_DAYS, detail=f"expected more than 0 and at most {MOST_DAYS:g} days"
)


def add_roster(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "file",
        nargs="?",
        type=Path,
        metavar="ROSTER.csv",
        help=(
            "CSV with a header: name; optional: role, full_name, email, student_id, section; or a roster of"
            " another tool; default: list the people"
        ),
    )
    parser.add_argument(
        "--tokens",
        type=Path,
        metavar="TOKENS.csv",
        help="also give each imported person a token to log in with, in this new file, readable only by you",
    )
    parser.add_argument(
        "--days", type=_days, help=f"with --tokens: days until the tokens expire (default {DAYS:g})"
    )
    parser.add_argument(
        "--column",
        action="append",
        type=_pair,
        metavar="FIELD=HEADING",
        help=f"the column that holds a field, one of {', '.join(FIELDS)}; repeatable; default: guess",
    )
    parser.add_argument(
        "--role",
        action="append",
        type=_pair,
        metavar="WORD=ROLE",
        help="the role that a word of the file means; repeatable",
    )
    parser.add_argument("--encoding", choices=ENCODINGS, help="encoding of the file; default: guess")
    parser.add_argument(
        "--confirm",
        action="store_true",
        help="import although something is unclear: run the command without this option first, to see it",
    )
    parser.set_defaults(run=_roster)


def add_token(parser: argparse.ArgumentParser) -> None:
    """Add the subcommands."""
    kinds = parser.add_subparsers(dest="kind", required=True)
    give = kinds.add_parser("give", help="create a token for a person and print it; it is shown only once")
    give.add_argument("name", help="user name")
    give.add_argument(
        "--new", action="store_true", help="add the person to the course as a student if they are not in it"
    )
    give.add_argument("--days", type=_days, default=DAYS, help=f"days until it expires (default {DAYS:g})")
    give.add_argument(
        "--scope",
        action="append",
        choices=["submit", "read", "login"],
        help="permission of the token; repeatable; default: all three",
    )
    give.set_defaults(run=_give)
    listing = kinds.add_parser("list", help="list tokens with their first characters, newest first")
    listing.add_argument("name", nargs="?", help="user name; default: everyone")
    listing.set_defaults(run=_list)
    revoke = kinds.add_parser("revoke", help="revoke a token immediately")
    revoke.add_argument("id", nargs="?", type=UUID, help="token id from polhode token list")
    revoke.add_argument("--person", metavar="NAME", help="revoke all tokens of a person instead")
    revoke.set_defaults(run=_revoke)


def add_password(parser: argparse.ArgumentParser) -> None:
    """Add the argument of the command."""
    parser.add_argument("name", help="user name")
    parser.set_defaults(run=_password)


def add_unlink(parser: argparse.ArgumentParser) -> None:
    """Add the argument of the command."""
    parser.add_argument("name", help="user name")
    parser.set_defaults(run=_unlink)


def _roster(arguments: argparse.Namespace) -> None:
    if arguments.file is None and (arguments.tokens or arguments.days):
        raise CommandError("--tokens and --days apply to an import: give the file ROSTER.csv too")
    if arguments.days and not arguments.tokens:
        raise CommandError("--days applies to tokens: give the file --tokens TOKENS.csv too")
    if arguments.file is None and (arguments.column or arguments.role or arguments.encoding):
        raise CommandError("--column, --role and --encoding apply to an import: give the file ROSTER.csv too")
    if arguments.file is not None:
        _import_roster(arguments)
        return
    rows = in_database(people.everybody)
    print(
        table(people.ROSTER, ([getattr(row, column) for column in people.ROSTER] for row in rows), end="\n"),
        end="",
    )


def _import_roster(arguments: argparse.Namespace) -> None:
    """Import the roster in one transaction, which commits only after the token file, if any, is complete."""
    choices = Choices(dict(arguments.column or ()), dict(arguments.role or ()), arguments.encoding)
    roster = read(arguments.file.read_bytes(), arguments.file.name, choices)

    async def import_roster(connection: Connection, target: TextIO | None = None) -> int:
        await people.lock_members(connection)
        plan = await compare(connection, roster, None)
        _print_columns(roster)
        _refuse_unclear(plan, confirmed=arguments.confirm)
        seconds = (arguments.days or DAYS) * tokens.DAY_S if target else None
        created = await carry_out(connection, plan, getpass.getuser(), seconds)
        if target:
            target.write(table(("name", "token"), created, end="\n"))
            target.flush()
        return len(plan.changes)

    if arguments.tokens is None:
        print(f"imported {in_transaction(import_roster)} people, without tokens")
        return
    with os.fdopen(os.open(arguments.tokens, NEW, 0o600), "w", newline="", encoding="utf-8") as target:
        try:
            number = in_transaction(lambda connection: import_roster(connection, target))
        except BaseException:
            arguments.tokens.unlink()
            raise
    print(f"imported {number} people; their tokens are in {arguments.tokens}")


def _pair(text: str) -> tuple[str, str]:
    """Return both sides of an equals sign."""
    name, sign, value = text.partition("=")
    if not sign:
        raise argparse.ArgumentTypeError("expected NAME=VALUE")
    return name, value


def _print_columns(roster: Roster) -> None:
    headings = roster.columns.headings
    print(", ".join(f"{FIELDS[field]}: {headings[field]}" for field in FIELDS if field in headings))
    if roster.columns.unused:
        print(_indented("columns not imported:", roster.columns.unused, 2))
    if roster.notes:
        print(_indented("lines that are not about a person:", roster.notes, 2))


def _refuse_unclear(plan: Plan, *, confirmed: bool) -> None:
    """Raise CommandError if the file has errors, or questions that are not ``confirmed``."""
    asked = [_indented(question.sentence, question.details, 4) for question in plan.questions]
    if plan.errors:
        heading = f"nothing was imported from {plan.roster.file}; correct:"
        raise CommandError("\n  ".join([_indented(heading, plan.errors, 2), *asked]))
    if asked and not confirmed:
        heading = f"nothing was imported from {plan.roster.file}; correct it, or confirm with --confirm:"
        raise CommandError("\n  ".join([heading, *asked]))
    for question in asked:
        print(question)


def _indented(heading: str, items: Sequence[str], indent: int) -> str:
    """Return a heading with indented items. What a terminal would obey is replaced in them."""
    printable = ("".join(c if c.isprintable() else "?" for c in item) for item in shortened(items))
    return f"\n{' ' * indent}".join([heading, *printable])


def _give(arguments: argparse.Namespace) -> None:
    name = people.normalize_name(arguments.name)

    async def create(connection: Connection) -> str | None:
        seconds, scopes = arguments.days * tokens.DAY_S, arguments.scope or tokens.SCOPES
        if not arguments.new and not await people.is_member(connection, name):
            return None
        await audit.record(connection, getpass.getuser(), "give token", name, {"scopes": list(scopes)})
        return await tokens.create(
            connection, name, label="issued by the course", scopes=scopes, seconds=seconds
        )

    token = in_transaction(create)
    if token is None:
        raise CommandError(
            f"no person named {name}: import a roster with polhode roster, or add this person with "
            f"polhode token give --new {shlex.quote(name)}"
        )
    print(token)


def _list(arguments: argparse.Namespace) -> None:
    rows = in_database(lambda database: tokens.all_of(database, arguments.name))
    for row in rows:
        state = (
            "revoked"
            if row.revoked_at
            else "expired"
            if row.expired
            else f"valid until {row.expires_at:%Y-%m-%d}"
        )
        used = f"used {row.used_at:%Y-%m-%d}" if row.used_at else "never used"
        print(f"{row.id}  {row.prefix}…  {row.name}  {','.join(row.scopes)}  {state}, {used}  {row.label}")
    if not rows:
        print("no tokens")


def _revoke(arguments: argparse.Namespace) -> int:
    if (arguments.id is None) == (arguments.person is None):
        raise CommandError("give exactly one of an id and --person NAME")

    async def revoke(connection: Connection) -> int:
        count = await tokens.revoke(connection, id=arguments.id, person=arguments.person)
        subject = str(arguments.id or arguments.person)
        await audit.record(connection, getpass.getuser(), "revoke token", subject, {"count": count})
        return count

    count = in_transaction(revoke)
    print(f"revoked {count} token(s)")
    return 0 if count else 1


def _password(arguments: argparse.Namespace) -> int:
    name = people.normalize_name(arguments.name)
    hashed = passwords.hash_password(passwords.normalize(_read_password(name), name))
    if not in_transaction(
        lambda connection: credentials.set_password(connection, name, hashed, by=getpass.getuser())
    ):
        print(
            f"polhode: no person named {name}: add people with polhode roster or polhode token give --new",
            file=sys.stderr,
        )
        return 1
    print(f"the password of {name} is set; all browser sessions of {name} are logged out")
    return 0


def _unlink(arguments: argparse.Namespace) -> int:
    if not in_transaction(
        lambda connection: credentials.unlink(connection, arguments.name, by=getpass.getuser())
    ):
        print(f"polhode: {arguments.name} has no linked OpenID account", file=sys.stderr)
        return 1
    print(f"the OpenID account of {arguments.name} is unlinked")
    return 0


def _read_password(name: str) -> str:
    """Return the password typed twice at a terminal, or the first line of standard input."""
    if not sys.stdin.isatty():
        return sys.stdin.readline().rstrip("\r\n")
    password = getpass.getpass(f"New password of {name}: ")
    if password != getpass.getpass("Repeat new password: "):
        raise passwords.InvalidPassword("the passwords do not match")
    return password
