"""The HTTP server of the application, and what it prints once it listens."""

import asyncio
import contextlib
import math
import socket
import time
from collections.abc import Callable, Mapping
from functools import partial
from types import FrameType
from typing import Any, cast

import uvicorn
from fastapi import FastAPI

from service.api.health import WorkerStatus
from service.app import create_app
from service.http.connections import ACCEPTED, Connection, Connections
from service.http.live_updates import Listener
from service.settings import Settings
from service.store.database import Database, is_outage, patiently
from service.store.people import first_instructor

BACKLOG = 4096  # connections that wait in the kernel to be accepted
CLOSE_S = 2  # seconds that a stopping server leaves to open responses, such as event streams
POLL_S, WORKERS_S = (
    0.2,
    30.0,
)  # how often the start looks for workers, and when it reports that there are none
NO_WORKER = "no worker is running, so submissions wait: start one with polhode worker"


def http_server(
    settings: Settings, find_loss: Callable[[], str | None] = lambda: None, *, announce: bool = False
) -> uvicorn.Server:
    """Return the HTTP server of the application, to run on a socket of ``open_socket``.

    ``settings.database_url`` must be set; for ``find_loss`` see ``create_app``. With ``announce`` the server
    prints where it listens and, once a worker has reported it, the isolation level.
    """
    config = uvicorn.Config(
        create_app(settings, find_loss),
        http=cast(Any, partial(Connection, connections=Connections(settings))),
        ws="none",
        backlog=ACCEPTED,
        log_config=None,
        access_log=False,
        server_header=False,
        timeout_graceful_shutdown=CLOSE_S,
    )
    return _Server(config, announce=announce)


class _Server(uvicorn.Server):
    """A uvicorn server that notifies waiting requests before it closes their connections."""

    def __init__(self, config: uvicorn.Config, *, announce: bool) -> None:
        super().__init__(config)
        self._announce = announce
        self._announcement: asyncio.Task[None] | None = None

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        for listening in sockets or ():
            listening.listen(
                BACKLOG
            )  # uvicorn's own backlog is also the number of connections accepted in one go
        if self.started and self._announce:
            assert isinstance(self.config.app, FastAPI)
            places = [one.getsockname()[:2] for one in sockets or ()]
            _print(f"listening on {', '.join(_address(host, port) for host, port in places)}")
            held = self.config.app.state.held
            self._announcement = asyncio.create_task(_announce(held, _address(*places[0])))

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        if self._announcement is not None:
            self._announcement.cancel()
        await super().shutdown(sockets)

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        assert isinstance(self.config.app, FastAPI)
        if (listener := self.config.app.state.held.get(Listener)) is not None:
            listener.leave()
        super().handle_exit(sig, frame)


def _address(host: str, port: int) -> str:
    return f"http://[{host}]:{port}" if ":" in host else f"http://{host}:{port}"


async def _announce(held: Mapping[type, Any], address: str) -> None:
    """Print the link that creates the first instructor, if there is none, and then the isolation level."""
    settings = held[Settings]
    read = partial(first_instructor.link_secret, held[Database], single_user=settings.is_single_user)
    secret = await patiently(read, math.inf)
    if secret is not None:
        address = (settings.public_url or address).rstrip("/")
        _print(
            f"for a course open {address}/start#token={secret} once: it creates the first instructor, and"
            " people log in from then on"
        )
    await _announce_isolation(held[WorkerStatus])


async def _announce_isolation(status: WorkerStatus) -> None:
    """Print the isolation level as soon as a worker has reported it; until then, why nothing is graded."""
    began, printed, isolation = time.monotonic(), "", None
    while isolation is None:
        reason = None
        try:
            isolation, reason = await status.current()
        except Exception as error:
            if not is_outage(error):
                raise
        late = time.monotonic() - began > WORKERS_S
        sentence = f"submissions are not accepted: {reason}" if reason else NO_WORKER if late else printed
        if isolation is not None:
            sentence = f"workers grade at isolation level {isolation}"
        if sentence != printed:
            _print(sentence)
            printed = sentence
        await asyncio.sleep(POLL_S)


def _print(sentence: str) -> None:
    with contextlib.suppress(OSError):  # a full disk or a closed pipe must not stop the server
        print(f"polhode: {sentence}", flush=True)
