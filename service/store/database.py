"""The connection to PostgreSQL: one engine per process, every wait bounded, an outage told apart from a mistake."""

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
ANSWER_S = 25.0  # longer than a statement may take: a server that is frozen does not end it
# What a server does with a client that is cut off or frozen: it gives up its locks within seconds.
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
    """Arguments of every connection: ``name`` as it shows in pg_stat_activity, and timeouts on both sides."""
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
    """The database behind ``url``; its tables must be up to date.

    ``connections`` is the most it opens at a time, ``wait_s`` how long a caller waits for one of them.
    """

    def __init__(self, url: str, name: str, connections: int = 8, wait_s: float = DATABASE_WAIT_S) -> None:
        self.url = url
        self.persons: dict[str, UUID] = {}  # ids known to be entered, by name
        self._engine = create_async_engine(
            driver_url(url),
            pool_size=1,
            max_overflow=connections - 1,
            pool_timeout=wait_s,
            hide_parameters=True,  # an error that is logged must not hold a student's source
            connect_args=connect_options(name),
        )
        self._reading = self._engine.execution_options(isolation_level="AUTOCOMMIT")  # one statement needs no transaction

    async def close(self) -> None:
        """Close all connections."""
        await self._engine.dispose()

    @asynccontextmanager
    async def begin(self) -> AsyncIterator[AsyncConnection]:
        """A transaction, committed at the end of the block."""
        async with _bounded(), self._engine.begin() as connection:
            yield connection

    async def rows(self, query: Executable | str, values: Mapping[str, Any] | None = None) -> Sequence[Row[Any]]:
        """All rows of a query, which changes nothing; SQL text names its ``values`` with a colon.

        Asked once more if the connection has died in the pool, which then lets go of all that are as old. Whoever goes away
        while waiting for the answer leaves the connection whole.
        """
        asked = text(query) if isinstance(query, str) else query
        try:
            return await asyncio.shield(asyncio.ensure_future(self._ask(asked, values)))
        except DBAPIError as error:
            if not error.connection_invalidated:
                raise
            return await asyncio.shield(asyncio.ensure_future(self._ask(asked, values)))

    async def _ask(self, query: Executable, values: Mapping[str, Any] | None) -> Sequence[Row[Any]]:
        async with _bounded(), self._reading.connect() as connection:
            return (await connection.execute(query, values)).all()

    async def ping(self) -> None:
        """Raise unless the database answers."""
        await self.rows("SELECT 1")


@asynccontextmanager
async def _bounded() -> AsyncIterator[None]:
    try:
        async with asyncio.timeout(ANSWER_S):
            yield
    except TimeoutError as error:
        raise NoConnection(f"the database has not answered for {ANSWER_S:g} s") from error


def is_outage(error: BaseException) -> bool:
    """Whether the database could not be reached or went away, so that the same may work later."""
    if isinstance(error, DBAPIError):
        return error.connection_invalidated or isinstance(error.orig, psycopg.OperationalError | psycopg.InterfaceError)
    return isinstance(error, NoConnection | psycopg.OperationalError | ConnectorException | OSError)


async def patiently(action: Callable[[], Awaitable[T]], most_s: float) -> T:
    """Repeat ``action`` while the database is out, for at most ``most_s``; it must be harmless to do twice."""
    until, pause = time.monotonic() + most_s, 0.1
    while True:
        try:
            return await action()
        except Exception as error:
            if not is_outage(error) or time.monotonic() + pause > until:
                raise
            await asyncio.sleep(pause)
            pause = min(2 * pause, 2.0)


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
