"""Migrate the tables of a database to this version, and check that they fit it."""

import asyncio
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from alembic import command
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import Connection, create_engine, text
from sqlalchemy.exc import DBAPIError

from service.store.database import Database, connect_options

TABLES = (
    "artefact", "assignment", "assignment_version", "audit", "course", "device_login", "extension", "grading",
    "grading_artefact",
    "member", "note", "oidc_account", "outcome", "override", "person", "regrade", "regrade_request", "result",
    "run", "secret",
    "source_comment", "submission", "token", "worker",
)  # fmt: skip
MIGRATIONS = Path(__file__).parent / "migrations"
# An arbitrary constant: a number names PostgreSQL's advisory locks.
MIGRATION_LOCK = 2_6_2026
MISSING_TABLES = f"""
SELECT name FROM unnest(CAST('{{{",".join(TABLES)}}}' AS text[])) AS name
    WHERE to_regclass(quote_ident(name)) IS NULL ORDER BY name
"""

_RESTORE = "restore a backup with polhode db restore --replace FILE"
_MARK = "polhode: has tables"  # so that a database whose tables were dropped is not taken for a new one
_COMMENT = "SELECT shobj_description(oid, 'pg_database') FROM pg_database WHERE datname = current_database()"
_MAY_COMMENT = f"""
SELECT pg_has_role(datdba, 'USAGE') AND ({_COMMENT}) IS NULL FROM pg_database
    WHERE datname = current_database()
"""


class WrongSchema(Exception):
    """The tables do not fit this version; the message says why and what to do."""


def driver_url(url: str) -> str:
    """Return a ``postgresql://`` address in the form that makes SQLAlchemy use psycopg."""
    return url.replace("postgresql://", "postgresql+psycopg://", 1).replace(
        "postgres://", "postgresql+psycopg://", 1
    )


def migrate(url: str) -> str:
    """Run the missing revisions in one transaction under an advisory lock, and return the revision reached.

    Raises WrongSchema if a later version wrote the tables, or if some are missing.
    """
    config = _alembic_config()
    bounded = {"connect_timeout": 5, "options": "-c lock_timeout=60s -c statement_timeout=600s"}
    with _begin(url, bounded) as connection:
        connection.execute(text("SELECT pg_advisory_xact_lock(:lock)"), {"lock": MIGRATION_LOCK})
        _check_revision(connection)
        config.attributes["connection"] = connection
        command.upgrade(config, "head")
        _check_tables(connection)
        _mark(connection)
        return str(MigrationContext.configure(connection).get_current_revision())


@contextmanager
def _begin(url: str, options: dict[str, Any]) -> Iterator[Connection]:
    """Open a transaction of SQLAlchemy, as Alembic wants it; the errors are psycopg's."""
    engine = create_engine(driver_url(url), connect_args=options)
    try:
        with engine.begin() as connection:
            yield connection
    except DBAPIError as error:
        raise (error.orig or error) from error
    finally:
        engine.dispose()


async def check_schema(database: Database) -> None:
    """Raise WrongSchema if a later version than this one wrote the tables."""
    await asyncio.to_thread(_check_schema, database.url)


def _check_schema(url: str) -> None:
    with _begin(url, connect_options("polhode tables")) as connection:
        _check_revision(connection)


def _alembic_config() -> Config:
    config = Config()
    config.set_main_option("script_location", str(MIGRATIONS))
    return config


def _check_revision(connection: Connection) -> None:
    revisions = ScriptDirectory.from_config(_alembic_config())
    found = MigrationContext.configure(connection).get_current_revision()
    if found is not None and found not in {one.revision for one in revisions.walk_revisions()}:
        raise WrongSchema(
            f"the database has the tables of revision {found}, and this version of polhode knows revisions up"
            f" to {revisions.get_current_head()}: install the later version that wrote them, or restore a"
            " backup of this version with polhode db restore --replace FILE"
        )
    if found is None and len(_missing_tables(connection)) < len(TABLES):
        raise WrongSchema(f"the table alembic_version of the database is missing or empty: {_RESTORE}")
    if found is None and connection.execute(text(_COMMENT)).scalar() == _MARK:
        raise WrongSchema(
            "the database is empty, and its comment says that it had tables: restore a backup with polhode db"
            " restore FILE; to start with an empty course, use a new database"
        )


def _missing_tables(connection: Connection) -> Sequence[str]:
    return connection.execute(text(MISSING_TABLES)).scalars().all()


def _check_tables(connection: Connection) -> None:
    if missing := _missing_tables(connection):
        raise WrongSchema(f"tables of the database are missing ({', '.join(missing)}): {_RESTORE}")


def _mark(connection: Connection) -> None:
    """Note in the database's comment that it has tables, if polhode may write it and there is no other
    comment.
    """
    if connection.execute(text(_MAY_COMMENT)).scalar():
        connection.execute(
            text(
                f"DO $$ BEGIN EXECUTE format('COMMENT ON DATABASE %I IS %L', current_database(), '{_MARK}');"
                " END $$"
            )
        )
