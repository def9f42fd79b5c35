"""The command ``polhode db``: upgrade, back up, restore and check the database."""

import argparse
import asyncio
import sys
from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, ParamSpec, TypeVar

from service.settings import Settings

if TYPE_CHECKING:
    from service.store.database import Database

P = ParamSpec("P")
T = TypeVar("T")


def add(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command and its subcommands."""
    parser = commands.add_parser("db", help="upgrade, back up, restore and check the database")
    actions = parser.add_subparsers(dest="action", required=True)
    actions.add_parser("upgrade", help="upgrade the tables to this version, as a starting server does").set_defaults(run=_upgrade)
    backup = actions.add_parser("backup", help="write all data to FILE; the server can keep running")
    backup.add_argument("file", type=Path, metavar="FILE", help="file to write")
    backup.set_defaults(run=_backup)
    restore = actions.add_parser("restore", help="load FILE into an empty database")
    restore.add_argument("file", type=Path, metavar="FILE", help="file written by polhode db backup")
    restore.add_argument("--replace", action="store_true", help="delete the database's present content first")
    restore.set_defaults(run=_restore)
    actions.add_parser("check", help="check the stored data for inconsistencies").set_defaults(run=_check)


@contextmanager
def database_url(settings: Settings, *, create: bool = False, restore: bool = False) -> Iterator[str]:
    """Provide the database's URL for the duration of the block, starting the embedded database if it is not
    running.

    ``create`` allows a first start, and ``restore`` a new database that replaces a missing one if the block
    succeeds. Raises DatabaseUnavailable if there is no database otherwise.
    """
    from service.store.postgres.os_user import DatabaseUnavailable
    from service.store.postgres.server import EmbeddedPostgres, running_url

    if url := settings.database_url or running_url(settings.data):
        yield url
        return
    exists = (settings.data / "postgres" / "PG_VERSION").exists()
    if not (exists or create or restore):
        raise DatabaseUnavailable(f"no database in {settings.data}: set POLHODE_DATA or POLHODE_DATABASE_URL")
    embedded = EmbeddedPostgres(settings.data, settings.postgres)
    if restore and not exists:
        with embedded.new_cluster() as url:
            yield url
        return
    embedded.start()
    try:
        yield embedded.url
    finally:
        embedded.stop()


def report_errors(command: Callable[P, int]) -> Callable[P, int]:
    """Wrap a command so that a database error prints one sentence and returns exit code 2."""

    def wrapped(*args: P.args, **kwargs: P.kwargs) -> int:
        import psycopg
        from sqlalchemy.exc import DBAPIError

        from service.store.database import WrongSchema
        from service.store.postgres.backup import BackupError
        from service.store.postgres.os_user import DatabaseUnavailable

        try:
            return command(*args, **kwargs)
        except (DatabaseUnavailable, WrongSchema, BackupError, OSError) as error:
            print(f"polhode: {error}", file=sys.stderr)
        except (psycopg.Error, DBAPIError) as error:
            cause = getattr(error, "orig", None) or error
            missing = isinstance(cause, psycopg.errors.UndefinedTable)
            first = str(cause).strip().split("\n")[0]
            print(f"polhode: {'the database has no tables yet: run polhode db upgrade' if missing else first}", file=sys.stderr)
        return 2

    return wrapped


def run_async(url: str, action: "Callable[[Database], Awaitable[T]]") -> T:
    """Return the result of ``action`` on the database at ``url``. Raises WrongSchema if a later version wrote it."""
    from service.store.database import Database, check_schema

    async def once() -> T:
        database = Database(url, "polhode command", connections=1)
        try:
            await check_schema(database)
            return await action(database)
        finally:
            await database.close()

    return asyncio.run(once())


@report_errors
def _upgrade(arguments: argparse.Namespace) -> int:
    from service.store.database import migrate

    with database_url(Settings(), create=True) as url:
        print(f"the database is upgraded to revision {migrate(url)}")
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
    from service.store.postgres.backup import check_file, restore
    from service.store.postgres.server import find_programs

    settings = Settings()
    check_file(arguments.file)
    with database_url(settings, restore=True) as url:
        restore(url, settings.postgres or find_programs(), arguments.file, replace=arguments.replace)
    print(f"restored from {arguments.file}; unfinished gradings start again")
    return 0


@report_errors
def _check(arguments: argparse.Namespace) -> int:
    from service.store.postgres.backup import check

    with database_url(Settings()) as url:
        run_async(url, lambda database: database.ping())  # checks the schema first
        found = check(url)
    for sentence, count in found.items():
        print(f"{'✗' if count else '✓'}  {count} {sentence}", file=sys.stdout)
    return 1 if any(found.values()) else 0
