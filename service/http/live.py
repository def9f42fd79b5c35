"""Who waits on this server for news of a submission: one connection that LISTENs, and everybody asleep until woken by it."""

import asyncio
import contextlib
import logging
from collections import defaultdict
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from hashlib import sha256
from typing import Any, Generic, TypeVar

import psycopg
from fastapi.sse import ServerSentEvent

from service.store.database import Database, connect_options, is_outage
from service.store.records import positions
from service.store.runs import CHANNEL

log = logging.getLogger(__name__)
LOOK_AGAIN_S = 2.0  # whoever waits looks after so long even without news, as news may be lost with a connection
POSITIONS_KEPT_S = 0.5


class Listener:
    """News of submissions, whichever worker or server they come from."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self._asleep: defaultdict[str, set[asyncio.Event]] = defaultdict(set)
        self._leaving = False
        self._task: asyncio.Task[None] | None = None
        self._positions: tuple[float, Mapping[str, int]] = (float("-inf"), {})
        self._asking = asyncio.Lock()

    def start(self) -> None:
        """Begin to listen."""
        self._task = asyncio.create_task(self._listen())

    async def stop(self) -> None:
        """Listen no more."""
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)

    def leave(self) -> None:
        """The server is about to end: whoever waits has a last look."""
        self._leaving = True
        self._wake_all()

    async def wait_for_changes(self, submission: str, seconds: float, every: float = LOOK_AGAIN_S) -> AsyncIterator[None]:
        """Now, after every news of the submission, and ``every`` so many seconds; ends after ``seconds``."""
        loop, event = asyncio.get_running_loop(), asyncio.Event()
        until = loop.time() + seconds
        self._asleep[submission].add(event)
        try:
            yield
            while (left := until - loop.time()) > 0 and not self._leaving:
                with contextlib.suppress(TimeoutError):
                    await asyncio.wait_for(event.wait(), min(every, left))
                event.clear()
                yield
        finally:
            self._asleep[submission].discard(event)
            if not self._asleep[submission]:
                del self._asleep[submission]

    async def position(self, grading: str) -> int | None:
        """Its place in the queue; read at most twice a second for everybody who asks."""
        async with self._asking:
            loop = asyncio.get_running_loop()
            if loop.time() - self._positions[0] > POSITIONS_KEPT_S:
                self._positions = loop.time(), await positions(self._database)
        return self._positions[1].get(grading)

    async def _listen(self) -> None:
        told = False  # of this outage
        while True:
            try:
                options = connect_options("polhode listener")
                async with await psycopg.AsyncConnection.connect(self._database.url, autocommit=True, **options) as connection:
                    await connection.execute(f"LISTEN {CHANNEL}")
                    self._wake_all()
                    told = False
                    while True:
                        async for news in connection.notifies(timeout=5):
                            self._wake(news.payload)
                        await connection.execute("SELECT 1")
            except Exception as error:
                if not told or not is_outage(error):
                    log.warning("listening again after %s", type(error).__name__)
                told = True
                await asyncio.sleep(0.5)

    def _wake(self, submission: str) -> None:
        for event in self._asleep.get(submission, ()):
            event.set()

    def _wake_all(self) -> None:
        for events in self._asleep.values():
            for event in events:
                event.set()


T = TypeVar("T")
EVERY_S = 1.0
LONGEST_S = 3600.0


class ChangeFeed(Generic[T]):
    """``look`` asks the database; ``shown`` makes of its answer what a page shows, whose text tells whether it has changed."""

    def __init__(self, listener: Listener, look: Callable[[], Awaitable[T]], shown: Callable[[T], Any]) -> None:
        self._listener, self._look, self._show = listener, look, shown
        self._asking = asyncio.Lock()
        self._seen: Any = None
        self._until = float("-inf")
        self._changes = 0

    async def now(self) -> Any:
        """What a page shows, at most a second old."""
        clock = asyncio.get_running_loop().time
        async with self._asking:
            if clock() >= self._until:
                changes = self._changes
                self._seen = self._show(await self._look())
                self._until = clock() + 0.95 * EVERY_S if changes == self._changes else float("-inf")
            return self._seen

    def changed(self) -> None:
        """Whoever looks next sees what is true from now on."""
        self._changes += 1
        self._until = float("-inf")

    async def events(self, told: str | None) -> AsyncIterator[ServerSentEvent]:
        """An event whenever what is shown is not what was ``told`` last, for an hour or until the server stops."""
        async for _ in self._listener.wait_for_changes("", LONGEST_S, EVERY_S):
            try:
                mark = sha256(repr(await self.now()).encode()).hexdigest()[:16]
            except Exception as error:
                if not is_outage(error):
                    raise
                continue
            if mark != told:
                yield ServerSentEvent(id=mark, data={"changed": True})
                told = mark
