"""Pages that tell news by themselves: what they show is looked at once a second, however many of them are open."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from hashlib import sha256
from typing import Any, Generic, TypeVar

from fastapi.sse import ServerSentEvent

from service.store.database import is_outage
from service.web.listener import Listener

T = TypeVar("T")
EVERY_S = 1.0
LONGEST_S = 3600.0


class Watch(Generic[T]):
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
        async for _ in self._listener.looks("", LONGEST_S, EVERY_S):
            try:
                mark = sha256(repr(await self.now()).encode()).hexdigest()[:16]
            except Exception as error:
                if not is_outage(error):
                    raise
                continue
            if mark != told:
                yield ServerSentEvent(id=mark, data={"changed": True})
                told = mark
