"""Connect to PostgreSQL, limit every wait, and distinguish outages from programming errors."""

import asyncio
import time
from abc import ABC, abstractmethod
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import Any, Self, TypeAlias, TypeVar

import psycopg
from procrastinate.exceptions import ConnectorException
from psycopg.adapt import Buffer, Loader
from psycopg.rows import namedtuple_row
from psycopg_pool import AsyncConnectionPool

from service.settings import DATABASE_WAIT_S

T = TypeVar("T")
Values = Mapping[str, Any]
Row: TypeAlias = Any
"""A named tuple of a query's columns."""
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


class DatabaseLost(Exception):
    """The folder of the embedded database is missing or damaged, as the message says."""


class ConnectionBroke(psycopg.OperationalError):
    """The connection in use broke."""


class NoRow(LookupError):
    """A query that must return a row returned none."""


class Queries(ABC):
    """Runs queries: a database, or a connection in a transaction.
    SQL text names its ``values`` as psycopg does, ``%(name)s``, and doubles other percent signs.
    """

    @abstractmethod
    async def rows(self, query: str, values: Values | None = None) -> Sequence[Row]:
        """Run a query and return all rows."""

    async def first(self, query: str, values: Values | None = None) -> Row | None:
        """Run a query and return its first row, or None."""
        return next(iter(await self.rows(query, values)), None)

    async def one(self, query: str, values: Values | None = None) -> Row:
        """Run a query and return its first row. Raises NoRow."""
        if (row := await self.first(query, values)) is None:
            raise NoRow(query)
        return row


@dataclass(frozen=True)
class Connection(Queries):
    """Connection in a transaction; ``raw`` is psycopg's."""

    raw: psycopg.AsyncConnection[Row]

    async def execute(self, query: str, values: Values | None = None) -> int:
        """Run a statement and return the number of its rows."""
        return (await self.raw.execute(query, values or {})).rowcount

    async def rows(self, query: str, values: Values | None = None) -> Sequence[Row]:
        """Run a query and return all rows."""
        return await (await self.raw.execute(query, values or {})).fetchall()


class _Number(Loader):
    """Read a numeric value as an int if it is whole, else as a float: points may be fractions."""

    def load(self, data: Buffer) -> int | float:
        value = float(bytes(data))
        return int(value) if value.is_integer() else value


async def _configure(connection: psycopg.AsyncConnection[Row]) -> None:
    connection.adapters.register_loader("numeric", _Number)


class Database(Queries):
    """A pool of at most ``connections`` connections to the database at ``url``, whose tables are up to date.
    It opens and closes as an asynchronous context manager.

    A caller waits at most ``wait_s`` seconds for a connection. ``find_loss`` returns the reason why the files
    of an embedded database are lost, or None; no transaction counts as committed while it returns a reason.
    """

    def __init__(
        self,
        url: str,
        name: str,
        connections: int = 8,
        wait_s: float = DATABASE_WAIT_S,
        find_loss: Callable[[], str | None] = lambda: None,
    ) -> None:
        self.url, self._find_loss = url, find_loss
        self._pool = AsyncConnectionPool(
            url,
            kwargs={"autocommit": True, "row_factory": namedtuple_row, **connect_options(name)},
            configure=_configure,
            min_size=0,
            max_size=connections,
            timeout=wait_s,
            reconnect_timeout=wait_s,
            open=False,
        )

    async def __aenter__(self) -> Self:
        await self._pool.open()
        return self

    async def __aexit__(self, *exception: object) -> None:
        await self._pool.close()

    @asynccontextmanager
    async def begin(self) -> AsyncIterator[Connection]:
        """Open a transaction; it is committed at the end of the block and rolled back if the block raises.

        Raises DatabaseLost, also if the files disappeared before the commit: they may be deleted files by
        then.
        """
        self._check_files()
        async with _bounded(), self._connected() as connection, connection.transaction():
            yield Connection(connection)
        self._check_files()

    @asynccontextmanager
    async def _connected(self) -> AsyncIterator[psycopg.AsyncConnection[Row]]:
        """Provide a connection. If it breaks meanwhile, replace the idle ones, which are as old, and raise
        ConnectionBroke.
        """
        async with self._pool.connection() as connection:
            try:
                yield connection
            except (psycopg.Error, ConnectorException) as error:
                if not connection.closed:
                    raise
                await self._pool.check()
                raise ConnectionBroke(str(error)) from error

    def _check_files(self) -> None:
        if loss := self._find_loss():
            raise DatabaseLost(loss)

    async def rows(self, query: str, values: Values | None = None) -> Sequence[Row]:
        """Run a read-only query and return all rows.

        If the connection turns out to be dead, the query runs once more on a new one.
        """
        self._check_files()
        async with _bounded():
            try:
                return await self._fetch(query, values)
            except ConnectionBroke:
                return await self._fetch(query, values)

    async def _fetch(self, query: str, values: Values | None) -> Sequence[Row]:
        async with self._connected() as connection:
            return await Connection(connection).rows(query, values)

    async def ping(self) -> None:
        """Run a trivial query. Raises an outage (see ``is_outage``) if the database does not answer."""
        await self.rows("SELECT 1")


@asynccontextmanager
async def _bounded() -> AsyncIterator[None]:
    try:
        async with asyncio.timeout(ANSWER_S):
            yield
    except TimeoutError as error:
        raise psycopg.OperationalError(f"the database has not answered for {ANSWER_S:g} s") from error


async def end_task(task: asyncio.Task[Any]) -> None:
    """Cancel a task that uses the database until it has ended.

    Before Python 3.12 a task may go on after ``cancel``: ``asyncio.wait_for``, with which psycopg_pool waits
    for a connection, loses a cancellation that comes together with the connection.
    """
    while not task.done():
        task.cancel()
        await asyncio.wait([task], timeout=0.1)


def is_outage(error: BaseException) -> bool:
    """Return whether the error means that the database is unreachable or lost, so that a retry may succeed
    once it is back.
    """
    outages = psycopg.OperationalError | psycopg.InterfaceError | ConnectorException | OSError
    return isinstance(error, outages) or is_loss(error)


def is_loss(error: BaseException) -> bool:
    """Return whether the error means that the database has lost its files or tables."""
    return isinstance(error, (DatabaseLost, *_WITHOUT_TABLES))


# What a query raises on a database without the tables, columns or functions of this version.
_WITHOUT_TABLES = (
    psycopg.errors.UndefinedTable,
    psycopg.errors.UndefinedColumn,
    psycopg.errors.UndefinedFunction,
)


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
