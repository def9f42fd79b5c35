"""Bring a database to this version's tables, one process at a time."""

from pathlib import Path

from alembic import command
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from sqlalchemy import create_engine, text

# Any constant of our own: PostgreSQL's advisory locks are named by a number.
MIGRATION_LOCK = 2_6_2026


def driver_url(url: str) -> str:
    """A ``postgresql://`` address for SQLAlchemy with the psycopg driver."""
    return url.replace("postgresql://", "postgresql+psycopg://", 1).replace("postgres://", "postgresql+psycopg://", 1)


def migrate(url: str) -> str:
    """Run the missing revisions in one transaction under a lock; the revision reached."""
    config = Config()
    config.set_main_option("script_location", str(Path(__file__).parent / "migrations"))
    bounded = {"connect_timeout": 5, "options": "-c lock_timeout=60s -c statement_timeout=600s"}
    engine = create_engine(driver_url(url), connect_args=bounded)
    try:
        with engine.begin() as connection:
            connection.execute(text("SELECT pg_advisory_xact_lock(:lock)"), {"lock": MIGRATION_LOCK})
            config.attributes["connection"] = connection
            command.upgrade(config, "head")
            return str(MigrationContext.configure(connection).get_current_revision())
    finally:
        engine.dispose()
