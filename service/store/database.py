"""Connect to PostgreSQL, limit every wait, and distinguish outages from programming errors."""

import asyncio
import time
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping, Sequence
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any, TypeVar
from uuid import UUID

import psycopg
from alembic import command
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from procrastinate.exceptions import ConnectorException
from sqlalchemy import Executable, Row, create_engine, text
from sqlalchemy.exc import DBAPIError
from sqlalchemy.exc import TimeoutError as NoConnection
from sqlalchemy.ext.asyncio import AsyncConnection, create_async_engine

from service.settings import DATABASE_WAIT_S

T = TypeVar("T")
CONNECT_S = 3
ANSWER_S = 25.0  # longer than statement_timeout, which a frozen server does not enforce
# Make the server release the locks of a disconnected or frozen client within seconds.
SERVER_SIDE = {
    "statement_timeout": "20s",
    "lock_timeout": "10s",
    "idle_in_transaction_session_timeout": "3s",
    "tcp_user_timeout": "4s",
    "tcp_keepalives_idle": "2",
    "tcp_keepalives_interval": "1",
    "tcp_keepalives_count": "2",
}


def connect_options(name: str) -> dict[str, Any]:
    """Return the arguments of a psycopg connection called ``name``, with timeouts on both sides."""
    return {
        "application_name": name,
        "connect_timeout": CONNECT_S,
        "keepalives_idle": 2,
        "keepalives_interval": 1,
        "keepalives_count": 2,
        "tcp_user_timeout": 4000,
        "options": " ".join(f"-c {option}={value}" for option, value in SERVER_SIDE.items()),
    }


class Database:
    """Pool of at most ``connections`` connections to the database at ``url``, whose tables are up to date.

    A caller waits at most ``wait_s`` seconds for a connection.
    """

    def __init__(self, url: str, name: str, connections: int = 8, wait_s: float = DATABASE_WAIT_S) -> None:
        self.url = url
        self.persons: dict[str, UUID] = {}  # ids of stored people, by name
        self._engine = create_async_engine(
            driver_url(url),
            pool_size=1,
            max_overflow=connections - 1,
            pool_timeout=wait_s,
            hide_parameters=True,  # keeps students' sources out of logged errors
            connect_args=connect_options(name),
        )
        self._reading = self._engine.execution_options(isolation_level="AUTOCOMMIT")  # a single statement needs no transaction

    async def close(self) -> None:
        """Close all connections."""
        await self._engine.dispose()

    @asynccontextmanager
    async def begin(self) -> AsyncIterator[AsyncConnection]:
        """Open a transaction; it is committed at the end of the block and rolled back if the block raises."""
        async with _bounded(), self._engine.begin() as connection:
            yield connection

    async def rows(self, query: Executable | str, values: Mapping[str, Any] | None = None) -> Sequence[Row[Any]]:
        """Run a read-only query and return all rows; SQL text names its ``values`` with a colon.

        If a pooled connection turns out to be dead, the pool drops it and its contemporaries and the query
        runs once more. Cancelling the caller does not interrupt the query, so its connection stays usable.
        """
        statement = text(query) if isinstance(query, str) else query
        try:
            return await asyncio.shield(asyncio.ensure_future(self._fetch(statement, values)))
        except DBAPIError as error:
            if not error.connection_invalidated:
                raise
            return await asyncio.shield(asyncio.ensure_future(self._fetch(statement, values)))

    async def _fetch(self, query: Executable, values: Mapping[str, Any] | None) -> Sequence[Row[Any]]:
        async with _bounded(), self._reading.connect() as connection:
            return (await connection.execute(query, values)).all()

    async def ping(self) -> None:
        """Run a trivial query. Raises an outage (see ``is_outage``) if the database does not answer."""
        await self.rows("SELECT 1")


@asynccontextmanager
async def _bounded() -> AsyncIterator[None]:
    try:
        async with asyncio.timeout(ANSWER_S):
            yield
    except TimeoutError as error:
        raise NoConnection(f"the database has not answered for {ANSWER_S:g} s") from error


def is_outage(error: BaseException) -> bool:
    """Return whether the error means that the database is unreachable, so that a retry may succeed."""
    if isinstance(error, DBAPIError):
        return error.connection_invalidated or isinstance(error.orig, psycopg.OperationalError | psycopg.InterfaceError)
    return isinstance(error, NoConnection | psycopg.OperationalError | ConnectorException | OSError)


async def patiently(action: Callable[[], Awaitable[T]], most_s: float) -> T:
    """Retry ``action`` during a database outage, for at most ``most_s`` seconds, and return its result.

    It must be idempotent.
    """
    until, pause = time.monotonic() + most_s, 0.1
    while True:
        try:
            return await action()
        except Exception as error:
            if not is_outage(error) or time.monotonic() + pause > until:
                raise
            await asyncio.sleep(pause)
            pause = min(2 * pause, 2.0)


# An arbitrary constant: a number names PostgreSQL's advisory locks.
MIGRATION_LOCK = 2_6_2026


def driver_url(url: str) -> str:
    """Return a ``postgresql://`` address in the form that makes SQLAlchemy use psycopg."""
    return url.replace("postgresql://", "postgresql+psycopg://", 1).replace("postgres://", "postgresql+psycopg://", 1)


def migrate(url: str) -> str:
    """Run the missing revisions in one transaction under an advisory lock, and return the revision reached."""
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
