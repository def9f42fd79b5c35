"""Live updates: one PostgreSQL LISTEN connection per server wakes the requests that wait for changes of
a submission.
"""

import asyncio
import contextlib
import logging
from collections import defaultdict
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from functools import partial
from hashlib import sha256
from typing import Any, Generic, TypeVar, cast
from uuid import UUID

import psycopg
from fastapi.sse import ServerSentEvent

from service.store.database import Database, Row, connect_options, end_task, is_outage
from service.store.queue.runs import CHANNEL, PROGRESS
from service.store.submissions import records

log = logging.getLogger(__name__)
POLL_S = 2.0  # polling interval, because a notification may be lost with its connection
POSITIONS_CACHED_S = 0.5
STATE_CACHED_S = 1.0  # less than POLL_S
EVERY_S = 1.0
LONGEST_S = 3600.0
T = TypeVar("T")


class Shared(Generic[T]):
    """A result of ``look``, which queries the database, for all who want it at the same time."""

    def __init__(self, look: Callable[[], Awaitable[T]]) -> None:
        self._look = look
        self._lock = asyncio.Lock()
        self._found: T | None = None
        self._valid_until = float("-inf")
        self._changes = 0

    async def current(self, seconds: float) -> T:
        """Return the result, at most so many ``seconds`` old, of a look that began after the last change."""
        clock = asyncio.get_running_loop().time
        async with self._lock:
            if clock() >= self._valid_until:
                changes = self._changes
                self._found = await self._look()
                self._valid_until = clock() + seconds if changes == self._changes else float("-inf")
            return cast(T, self._found)

    def invalidate(self) -> None:
        """Discard the result after a change."""
        self._changes += 1
        self._valid_until = float("-inf")


class Listener:
    """Wakes waiting requests when a submission changes, on whichever worker or server."""

    def __init__(self, database: Database) -> None:
        self._database = database
        # whether also for progress
        self._waiting: defaultdict[str, dict[asyncio.Event, bool]] = defaultdict(dict)
        self._stopping = False
        self._task: asyncio.Task[None] | None = None
        self._positions: Shared[Mapping[str, int]] = Shared(lambda: records.positions(database))
        self._states: dict[str, Shared[Row | None]] = {}  # of submissions with waiting requests

    def start(self) -> None:
        """Start listening."""
        self._task = asyncio.create_task(self._listen())

    async def stop(self) -> None:
        """Stop listening."""
        if self._task is not None:
            await end_task(self._task)

    def leave(self) -> None:
        """Wake all waiting requests a last time, because the server is about to stop."""
        self._stopping = True
        self._wake_all()

    async def wait_for_changes(
        self, submission: str, seconds: float, every: float = POLL_S, *, progress: bool = True
    ) -> AsyncIterator[None]:
        """Yield immediately, after each change of the submission, and at least every ``every`` seconds; end
        after ``seconds``.

        If ``progress`` is false, ignore notifications of progress.
        """
        loop, event = asyncio.get_running_loop(), asyncio.Event()
        until = loop.time() + seconds
        self._waiting[submission][event] = progress
        try:
            yield
            while (left := until - loop.time()) > 0 and not self._stopping:
                with contextlib.suppress(TimeoutError):
                    await asyncio.wait_for(event.wait(), min(every, left))
                event.clear()
                yield
        finally:
            self._waiting[submission].pop(event, None)
            if not self._waiting[submission]:
                del self._waiting[submission]
                self._states.pop(submission, None)

    async def state(self, submission: UUID) -> Row | None:
        """Return the state of a submission for a request that waits for its changes (``records.state``).

        All of them share one query after each change and one a second.
        """
        look = partial(records.state, self._database, submission)
        return await self._states.setdefault(str(submission), Shared(look)).current(STATE_CACHED_S)

    async def position(self, grading: str) -> int | None:
        """Return the position in the queue, None if it is not queued.

        All requests share a cache of half a second.
        """
        return (await self._positions.current(POSITIONS_CACHED_S)).get(grading)

    async def _listen(self) -> None:
        logged = False  # this outage
        while True:
            try:
                options = connect_options("polhode listener")
                async with await psycopg.AsyncConnection.connect(
                    self._database.url, autocommit=True, **options
                ) as connection:
                    await connection.execute(f"LISTEN {CHANNEL}")
                    self._wake_all()
                    logged = False
                    while True:
                        async for notification in connection.notifies(timeout=5):
                            self._wake(notification.payload)
                        await connection.execute("SELECT 1")
            except Exception as error:
                if not logged or not is_outage(error):
                    log.warning("reconnecting the listener after %s", type(error).__name__)
                logged = True
                await asyncio.sleep(0.5)

    def _wake(self, notification: str) -> None:
        submission = notification.removesuffix(PROGRESS)
        if submission in self._states:
            self._states[submission].invalidate()
        for event, also_progress in self._waiting.get(submission, {}).items():
            if also_progress or submission == notification:
                event.set()

    def _wake_all(self) -> None:
        for state in self._states.values():
            state.invalidate()
        for events in self._waiting.values():
            for event in events:
                event.set()


class ChangeFeed(Generic[T]):
    """A page's data and the events that announce its changes.

    ``look`` queries the database and ``shown`` turns its result into the data that the page shows. The data
    has changed if its ``repr`` has.
    """

    def __init__(
        self, listener: Listener, look: Callable[[], Awaitable[T]], shown: Callable[[T], Any]
    ) -> None:
        async def data() -> Any:
            return shown(await look())

        self._listener, self._data = listener, Shared(data)

    async def current(self) -> Any:
        """Return the page's data, at most a second old."""
        return await self._data.current(0.95 * EVERY_S)

    def invalidate(self) -> None:
        """Discard the cached data after a change."""
        self._data.invalidate()

    async def events(self, last_id: str | None) -> AsyncIterator[ServerSentEvent]:
        """Yield an event whenever the data differs from that of the event ``last_id``, for an hour or
        until the server stops.
        """
        async for _ in self._listener.wait_for_changes("", LONGEST_S, EVERY_S):
            try:
                id = sha256(repr(await self.current()).encode()).hexdigest()[:16]
            except Exception as error:
                if not is_outage(error):
                    raise
                continue
            if id != last_id:
                yield ServerSentEvent(id=id, data={"changed": True})
                last_id = id
