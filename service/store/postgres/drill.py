"""Try a backup: restore it into an empty database of its own and compare every row."""

from pathlib import Path
from typing import NamedTuple

import psycopg
from psycopg import sql

from service.store.postgres import backup
from service.store.postgres.server import EmbeddedPostgres


class Contents(NamedTuple):
    """The number of rows of a table, and a hash of them that does not depend on their order."""

    rows: int
    hash: str


def back_up(url: str, programs: Path, file: Path) -> dict[str, Contents]:
    """Write a backup to ``file`` while the server runs. Return the contents of each table at that moment.
    Raises BackupError.
    """
    with psycopg.connect(url) as connection:
        connection.isolation_level = psycopg.IsolationLevel.REPEATABLE_READ
        snapshot = connection.execute("SELECT pg_export_snapshot()").fetchone()
        assert snapshot is not None
        backup.backup(url, programs, file, snapshot[0])
        return contents(connection)


def restore(file: Path, programs: Path, folder: Path) -> tuple[dict[str, Contents], dict[str, int]]:
    """Restore ``file`` into a new database in ``folder``. Return the contents of each table, and what
    ``backup.check`` finds.

    Raises BackupError and DatabaseUnavailable.
    """
    with EmbeddedPostgres(folder, programs).new_cluster() as url:
        backup.restore(url, programs, file)
        with psycopg.connect(url) as connection:
            return contents(connection), dict(backup.check(url))


def contents(connection: psycopg.Connection) -> dict[str, Contents]:
    """Return the contents of every table."""
    connection.execute("SET LOCAL timezone = 'UTC'")
    names = [row[0] for row in connection.execute(_TABLES).fetchall()]
    found = {}
    for name in names:
        row = connection.execute(sql.SQL(_CONTENTS).format(sql.Identifier(name))).fetchone()
        assert row is not None
        found[name] = Contents(*row)
    return found


_TABLES = "SELECT tablename FROM pg_tables WHERE schemaname = 'public' ORDER BY tablename"
_CONTENTS = "SELECT count(*), coalesce(sum(hashtextextended(CAST(t AS text), 0)), 0)::text FROM public.{} t"
