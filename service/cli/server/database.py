"""The command ``polhode db``: upgrade, back up, restore, check and prune the database, and try a backup."""

import argparse
import asyncio
import tempfile
from collections.abc import Awaitable, Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TypeVar

import psycopg

from exercises.authoring.assignments.catalogue import assignments
from service.cli.arguments import number
from service.cli.errors import CommandError
from service.settings import Settings
from service.store.database import Connection, Database
from service.store.postgres import backup, drill, retention
from service.store.postgres.os_user import DatabaseUnavailable
from service.store.postgres.server import EmbeddedPostgres, find_programs, running_url
from service.store.schema import check_schema, migrate

T = TypeVar("T")
_days = number(float, lambda days: 0 <= days <= 1e5, detail="expected 0 to 100000 days")


def add_db(parser: argparse.ArgumentParser) -> None:
    """Add the subcommands."""
    actions = parser.add_subparsers(dest="action", required=True)
    actions.add_parser(
        "upgrade", help="upgrade the tables to this version, as a starting server does"
    ).set_defaults(run=_upgrade)
    write = actions.add_parser("backup", help="write all data to FILE; the server can keep running")
    write.add_argument("file", type=Path, metavar="FILE", help="file to write")
    write.set_defaults(run=_backup)
    restore = actions.add_parser("restore", help="load FILE into an empty database")
    restore.add_argument("file", type=Path, metavar="FILE", help="file written by polhode db backup")
    restore.add_argument("--replace", action="store_true", help="delete the database's present content first")
    restore.set_defaults(run=_restore)
    actions.add_parser("check", help="check the stored data for inconsistencies").set_defaults(run=_check)
    drill = actions.add_parser(
        "drill", help="restore a new backup, or FILE, into an empty database of its own, and compare"
    )
    drill.add_argument(
        "file",
        type=Path,
        metavar="FILE",
        nargs="?",
        help="file written by polhode db backup; default: a new one",
    )
    drill.set_defaults(run=_drill)
    prune = actions.add_parser("prune", help="count stored files that polhode can make again, or delete them")
    prune.add_argument(
        "--older-than", type=_days, default=30.0, metavar="DAYS", help="only of results this old (default 30)"
    )
    prune.add_argument(
        "--arrays",
        action="store_true",
        help=(
            "not figures, but the arrays that reports were made from: figures that nobody has opened then"
            " need a regrade"
        ),
    )
    prune.add_argument("--delete", action="store_true", help="delete them; default: only count")
    prune.set_defaults(run=_prune)


@contextmanager
def database_url(settings: Settings, *, create: bool = False, restore: bool = False) -> Iterator[str]:
    """Provide the database's URL for the duration of the block, starting the embedded database if it is not
    running.

    ``create`` allows a first start, and ``restore`` a new database that replaces a missing one if the block
    succeeds. Raises DatabaseUnavailable if there is no database otherwise, CommandError for an error of a
    query.
    """
    exists = (settings.data / "postgres" / "PG_VERSION").exists()
    try:
        with ExitStack() as stack:
            url = settings.database_url or running_url(settings.data)
            if url is None and not (exists or create or restore):
                raise DatabaseUnavailable(
                    f"no database in {settings.data}: set POLHODE_DATA or POLHODE_DATABASE_URL"
                )
            if url is None:
                embedded = EmbeddedPostgres(settings.data, settings.postgres)
                url = stack.enter_context(
                    embedded.new_cluster() if restore and not exists else _running(embedded)
                )
            yield url
    except psycopg.errors.UndefinedTable as error:
        raise CommandError("the database has no tables yet: run polhode db upgrade") from error
    except psycopg.Error as error:
        raise CommandError(str(error).strip().split("\n")[0]) from error


@contextmanager
def _running(embedded: EmbeddedPostgres) -> Iterator[str]:
    embedded.start()
    try:
        yield embedded.url
    finally:
        embedded.stop()


def run_async(url: str, action: Callable[[Database], Awaitable[T]]) -> T:
    """Return the result of ``action`` on the database at ``url``. Raises WrongSchema if a later version wrote
    it.
    """

    async def once() -> T:
        async with Database(url, "polhode command", connections=1) as database:
            await check_schema(database)
            return await action(database)

    return asyncio.run(once())


def in_database(action: Callable[[Database], Awaitable[T]]) -> T:
    """Return the result of ``action`` on the database of the settings. Raises as ``database_url`` and
    ``run_async`` do.
    """
    with database_url(Settings()) as url:
        return run_async(url, action)


def in_transaction(action: Callable[[Connection], Awaitable[T]]) -> T:
    """Return the result of ``action`` in one transaction on the database of the settings."""

    async def begun(database: Database) -> T:
        async with database.begin() as connection:
            return await action(connection)

    return in_database(begun)


def _upgrade(arguments: argparse.Namespace) -> None:
    with database_url(Settings(), create=True) as url:
        print(f"the database is upgraded to revision {migrate(url)}")


def _backup(arguments: argparse.Namespace) -> None:
    settings = Settings()
    with database_url(settings) as url:
        backup.backup(url, settings.postgres or find_programs(), arguments.file)
    print(f"{arguments.file}: {arguments.file.stat().st_size} bytes")


def _restore(arguments: argparse.Namespace) -> None:
    settings = Settings()
    backup.check_file(arguments.file)
    with database_url(settings, restore=True) as url:
        backup.restore(url, settings.postgres or find_programs(), arguments.file, replace=arguments.replace)
    print(f"restored from {arguments.file}; unfinished gradings start again")


def _check(arguments: argparse.Namespace) -> int:
    with database_url(Settings()) as url:
        run_async(url, lambda database: database.ping())  # checks the schema first
        found = backup.check(url)
    for sentence, count in found.items():
        print(f"{'✗' if count else '✓'}  {count} {sentence}")
    return 1 if any(found.values()) else 0


def _prune(arguments: argparse.Namespace) -> None:
    versions = {slug: assignment.version for slug, assignment in assignments().items()}
    options = {"days": arguments.older_than, "arrays": arguments.arrays, "delete": arguments.delete}
    with database_url(Settings()) as url:
        run_async(url, lambda database: database.ping())  # checks the schema first
        found = retention.prune(url, versions, **options)
    for kind, files, size in found:
        print(f"{files} files, {size / 1e6:.1f} MB: {FILES[kind]}")
    print(
        "deleted; PostgreSQL uses the space for new data"
        if arguments.delete
        else "nothing was deleted: --delete deletes them"
    )


FILES = {
    "replaced": (
        "files of gradings that are not shown, as a later grading replaced them or the regrade was dropped"
    ),
    "drawn": "figures and motions, which the next request draws again",
    "arrays": "arrays that reports were made from; a regrade makes them again",
}


def _drill(arguments: argparse.Namespace) -> int:
    settings, before = Settings(), {}
    programs = settings.postgres or find_programs()
    with tempfile.TemporaryDirectory(prefix="polhode-drill-", ignore_cleanup_errors=True) as folder:
        file = arguments.file or Path(folder) / "backup"
        if arguments.file is None:
            with database_url(settings) as url:
                before = drill.back_up(url, programs, file)
        backup.check_file(file)
        after, broken = drill.restore(file, programs, Path(folder) / "data")
    rows, number = sum(table.rows for table in after.values()), after["submission"].rows
    print(f"restored into an empty database: {number} submissions, {rows} rows of {len(after)} tables")
    different = [name for name in before if before[name] != after.get(name)]
    for name in different:
        restored = after[name].rows if name in after else 0
        other = ", with other values" if restored == before[name].rows else ""
        print(f"✗  {name}: {restored} rows restored of {before[name].rows}{other}")
    for sentence in (sentence for sentence, count in broken.items() if count):
        print(f"✗  {broken[sentence]} {sentence}")
    good = not different and not any(broken.values())
    if good:
        print(
            "✓  every row is the same, and the data is consistent" if before else "✓  the data is consistent"
        )
    return 0 if good else 1
