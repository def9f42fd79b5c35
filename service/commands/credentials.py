"""polhode password and unlink: how a person logs in, set right by who runs the server."""

import argparse
import getpass
import sys
from typing import TYPE_CHECKING

from service.commands.reach import database_url, do, telling_why
from service.settings import Settings

if TYPE_CHECKING:
    from service.store.database import Database


def add(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the commands."""
    password = commands.add_parser("password", help="set a person's password, asked for here or read from standard input")
    password.add_argument("name")
    password.set_defaults(run=_password)
    unlink = commands.add_parser("unlink", help="forget which account at the OpenID provider is a person's")
    unlink.add_argument("name")
    unlink.set_defaults(run=_unlink)


@telling_why
def _password(arguments: argparse.Namespace) -> int:
    from service import passwords
    from service.store import credentials, people

    try:
        name = people.tidy(arguments.name)
        kept = passwords.hashed(passwords.tidy(_asked(name), name))
    except (people.NoName, passwords.NotGood) as error:
        print(f"polhode: {error}", file=sys.stderr)
        return 2

    async def keep(database: "Database") -> bool:
        async with database.begin() as connection:
            return await credentials.set_password(connection, name, kept, by=getpass.getuser())

    with database_url(Settings()) as url:
        known = do(url, keep)
    if not known:
        print(f"polhode: nobody is called {name} here: polhode roster and polhode token give enter people", file=sys.stderr)
        return 1
    print(f"the password of {name} is set; their browsers are logged out")
    return 0


@telling_why
def _unlink(arguments: argparse.Namespace) -> int:
    from service.store import credentials

    async def forget(database: "Database") -> bool:
        async with database.begin() as connection:
            return await credentials.unlink(connection, arguments.name, by=getpass.getuser())

    with database_url(Settings()) as url:
        known = do(url, forget)
    print(f"{arguments.name} is connected to no account any more" if known else f"{arguments.name} was connected to none")
    return 0 if known else 1


def _asked(name: str) -> str:
    """What is typed twice at a terminal, or the first line of the input."""
    from service import passwords

    if not sys.stdin.isatty():
        return sys.stdin.readline().rstrip("\r\n")
    asked = getpass.getpass(f"New password of {name}: ")
    if asked != getpass.getpass("The same again: "):
        raise passwords.NotGood("that was not the same twice")
    return asked
