"""polhode db: bring it up to date, back it up, restore it, check it."""

import argparse
import sys
from pathlib import Path

from service.commands.reach import database_url, telling_why
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


@telling_why
def _upgrade(arguments: argparse.Namespace) -> int:
    from service.store.migrate import migrate

    with database_url(Settings(), create=True) as url:
        print(f"the tables are at revision {migrate(url)}")
    return 0


@telling_why
def _backup(arguments: argparse.Namespace) -> int:
    from service.store.dump import backup
    from service.store.postgres import find_programs

    settings = Settings()
    with database_url(settings) as url:
        backup(url, settings.postgres or find_programs(), arguments.file)
    print(f"{arguments.file}: {arguments.file.stat().st_size} bytes")
    return 0


@telling_why
def _restore(arguments: argparse.Namespace) -> int:
    from service.store.dump import restore
    from service.store.postgres import find_programs

    settings = Settings()
    with database_url(settings, create=True) as url:
        restore(url, settings.postgres or find_programs(), arguments.file, replace=arguments.replace)
    print(f"restored from {arguments.file}; what was being graded will be graded again")
    return 0


@telling_why
def _check(arguments: argparse.Namespace) -> int:
    from service.store.dump import check

    with database_url(Settings()) as url:
        found = check(url)
    for sentence, count in found.items():
        print(f"{'✗' if count else '✓'}  {count} {sentence}", file=sys.stdout)
    return 1 if any(found.values()) else 0
