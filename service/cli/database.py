"""polhode db: bring it up to date, back it up, restore it, check it."""

import argparse
import asyncio
import sys
from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, ParamSpec, TypeVar

from service.settings import Settings


def add(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command and its subcommands."""
    parser = commands.add_parser("db", help="the database: upgrade, backup, restore, check")
    actions = parser.add_subparsers(dest="action", required=True)
    actions.add_parser("upgrade", help="bring the tables to this version, as a starting server does").set_defaults(run=_upgrade)
    backup = actions.add_parser("backup", help="write everything into FILE, while the server works")
    backup.add_argument("file", type=Path, metavar="FILE")
    backup.set_defaults(run=_backup)
    restore = actions.add_parser("restore", help="read FILE into an empty database")
    restore.add_argument("file", type=Path, metavar="FILE")
    restore.add_argument("--replace", action="store_true", help="drop what is in the database")
    restore.set_defaults(run=_restore)
    actions.add_parser("check", help="check that what is stored fits together").set_defaults(run=_check)


if TYPE_CHECKING:
    from service.settings import Settings
    from service.store.database import Database

P = ParamSpec("P")
T = TypeVar("T")


@contextmanager
def database_url(settings: "Settings", *, create: bool = False) -> Iterator[str]:
    """Where the database is, for the duration of the block. DatabaseUnavailable where there is none and none is to be made."""
    from service.store.postgres.os_user import DatabaseUnavailable
    from service.store.postgres.server import EmbeddedPostgres, running_url

    if url := settings.database_url or running_url(settings.data):
        yield url
        return
    if not create and not (settings.data / "postgres" / "PG_VERSION").exists():
        raise DatabaseUnavailable(f"there is no database in {settings.data} (POLHODE_DATA)")
    embedded = EmbeddedPostgres(settings.data, settings.postgres)
    embedded.start()
    try:
        yield embedded.url
    finally:
        embedded.stop()


def report_errors(command: Callable[P, int]) -> Callable[P, int]:
    """Exit code 2 and a sentence where the database does not do what is asked."""

    def wrapped(*args: P.args, **kwargs: P.kwargs) -> int:
        import psycopg
        from sqlalchemy.exc import DBAPIError

        from service.store.postgres.backup import BackupError
        from service.store.postgres.os_user import DatabaseUnavailable

        try:
            return command(*args, **kwargs)
        except (DatabaseUnavailable, BackupError, OSError) as error:
            print(f"polhode: {error}", file=sys.stderr)
        except (psycopg.Error, DBAPIError) as error:
            cause = getattr(error, "orig", None) or error
            missing = isinstance(cause, psycopg.errors.UndefinedTable)
            first = str(cause).strip().split("\n")[0]
            print(f"polhode: {'the database has no tables yet: polhode db upgrade' if missing else first}", file=sys.stderr)
        return 2

    return wrapped


def run_async(url: str, action: "Callable[[Database], Awaitable[T]]") -> T:
    """What ``action`` makes of the database behind ``url``."""
    from service.store.database import Database

    async def once() -> T:
        database = Database(url, "polhode command", connections=1)
        try:
            return await action(database)
        finally:
            await database.close()

    return asyncio.run(once())


@report_errors
def _upgrade(arguments: argparse.Namespace) -> int:
    from service.store.database import migrate

    with database_url(Settings(), create=True) as url:
        print(f"the tables are at revision {migrate(url)}")
    return 0


@report_errors
def _backup(arguments: argparse.Namespace) -> int:
    from service.store.postgres.backup import backup
    from service.store.postgres.server import find_programs

    settings = Settings()
    with database_url(settings) as url:
        backup(url, settings.postgres or find_programs(), arguments.file)
    print(f"{arguments.file}: {arguments.file.stat().st_size} bytes")
    return 0


@report_errors
def _restore(arguments: argparse.Namespace) -> int:
    from service.store.postgres.backup import restore
    from service.store.postgres.server import find_programs

    settings = Settings()
    with database_url(settings, create=True) as url:
        restore(url, settings.postgres or find_programs(), arguments.file, replace=arguments.replace)
    print(f"restored from {arguments.file}; what was being graded will be graded again")
    return 0


@report_errors
def _check(arguments: argparse.Namespace) -> int:
    from service.store.postgres.backup import check

    with database_url(Settings()) as url:
        found = check(url)
    for sentence, count in found.items():
        print(f"{'✗' if count else '✓'}  {count} {sentence}", file=sys.stdout)
    return 1 if any(found.values()) else 0
