"""Who waits on this server for news of a submission: one connection that LISTENs, and everybody asleep until woken by it."""

import asyncio
import contextlib
import logging
from collections import defaultdict
from collections.abc import AsyncIterator, Mapping

import psycopg

from service.store.database import Database, connect_options, is_outage
from service.store.reading import positions
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

    async def looks(self, submission: str, seconds: float, every: float = LOOK_AGAIN_S) -> AsyncIterator[None]:
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

    async def position(self, attempt: str) -> int | None:
        """Its place in the queue; read at most twice a second for everybody who asks."""
        async with self._asking:
            loop = asyncio.get_running_loop()
            if loop.time() - self._positions[0] > POSITIONS_KEPT_S:
                self._positions = loop.time(), await positions(self._database)
        return self._positions[1].get(attempt)

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
