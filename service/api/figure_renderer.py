"""Rendering of figures and charts in one separate process, started when somebody waits for a report with
figures, or else on the first request for an unstored picture.
"""

import asyncio
import contextlib
from collections.abc import Callable, Coroutine, Sequence
from functools import partial
from typing import Any, TypeVar
from weakref import WeakValueDictionary

from exercises.authoring.assignments.catalogue import assignments
from service.api.separate_process import ProcessLost, SeparateProcess
from service.grading.figures import rendering
from service.sandbox.result import SystemFault
from service.store.submissions.records import SubmissionRecord

T = TypeVar("T")
TIMEOUT_S = 60.0


class RenderFailed(Exception):
    """The rendering process died or timed out. The next picture starts a new one."""


class Renderer:
    """Renders figures and charts, one at a time. Persons take turns, so that who wants many delays nobody."""

    def __init__(self) -> None:
        self._process = SeparateProcess(TIMEOUT_S)
        self._tasks: dict[tuple[Any, ...], asyncio.Task[bytes]] = {}
        self._prepared: dict[str, asyncio.Task[None]] = {}
        self._turns: WeakValueDictionary[str, asyncio.Lock] = WeakValueDictionary()

    def prepare(self, slug: str) -> None:
        """Start loading what the figures of an assignment need, if it has figures,
        once per server process.
        """
        if (
            slug not in self._prepared
            and slug in assignments()
            and any(e.figures for e in assignments()[slug].exercises)
        ):
            self._prepared[slug] = asyncio.ensure_future(self._prepare(slug))

    async def _prepare(self, slug: str) -> None:
        with contextlib.suppress(RenderFailed, SystemFault):  # the first figure reports it
            await self._call(rendering.prepare, slug)

    async def figure(
        self, stored: SubmissionRecord, name: str, packed: bytes, form: str, *, narrow: bool = False
    ) -> bytes:
        """Return a figure of a graded submission as PNG or SVG, with its panels stacked if it is ``narrow``.

        Raises ArithmeticError or ValueError if its numbers cannot be drawn.
        """
        key = stored.grading, name, form, narrow
        draw = partial(rendering.draw_stored, narrow=narrow)
        of_figure = stored.assignment, name, packed, stored.seed, form
        return await self._shared(key, self._in_turn(stored.person, draw, *of_figure))

    async def class_sweep(self, documents: Sequence[dict[str, Any]]) -> bytes:
        """Return the chart of a class's sweeps over the reference methods as SVG."""
        key = "class", len(documents), str(documents)
        return await self._shared(key, self._call(rendering.draw_class, documents))

    def stop(self) -> None:
        """Kill the rendering process."""
        self._process.stop()

    async def _shared(self, key: tuple[Any, ...], rendered: Coroutine[Any, Any, bytes]) -> bytes:
        """Render once for concurrent requests; a disconnecting client does not cancel the rendering."""
        if key in self._tasks:
            rendered.close()
        else:
            self._tasks[key] = task = asyncio.ensure_future(rendered)
            task.add_done_callback(lambda _: self._tasks.pop(key, None))
        return await asyncio.shield(self._tasks[key])

    async def _in_turn(self, person: str, function: Callable[..., T], *args: Any) -> T:
        """Call the function, one at a time for each person."""
        turn = self._turns.setdefault(person, asyncio.Lock())
        async with turn:
            return await self._call(function, *args)

    async def _call(self, function: Callable[..., T], *args: Any) -> T:
        try:
            return await self._process.call(function, *args)
        except ProcessLost as error:
            raise RenderFailed from error
