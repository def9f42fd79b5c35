"""HTTP connections that clients cannot hold without end: uvicorn's HTTP/1.1 protocol with a deadline for
every request, a limit of open connections, and stricter framing.

uvicorn's own settings do not reach these: ``timeout_keep_alive`` ends with the first byte of a request, and
``limit_concurrency`` answers 503 to everybody while idle connections fill it.
"""

import asyncio
import contextlib
import random
import re
import resource
from collections import Counter
from typing import Any

import h11
from prometheus_client import Counter as Metric
from starlette.types import ASGIApp
from uvicorn.middleware.proxy_headers import ProxyHeadersMiddleware
from uvicorn.protocols.http.h11_impl import H11Protocol

from service.http.errors import PROBLEM_TYPE, problem_response
from service.http.metrics import PROCESS
from service.http.requests import network
from service.settings import Settings

ACCEPTED = (
    16  # most connections that asyncio accepts before it attends to others and their protocols can close some
)
OTHER_FILES = (
    128  # descriptors kept for the database, the workers' pipes and files; an idle server has about 40
)
SPREAD = 0.5  # deadlines vary from one to one and a half times their setting
LOWEST_RATE = (
    10_000  # bytes per second, on average, of a request body after its first ``body_timeout`` seconds
)
CLOSED = Metric("polhode_http_closed", "Connections closed by a limit.", ["limit"], registry=PROCESS)
REFUSED = (
    b"HTTP/1.1 503 Service Unavailable\r\nConnection: close\r\nRetry-After: 5\r\nContent-Length: 0\r\n\r\n"
)
TIMED_OUT = (
    b"HTTP/1.1 408 Request Timeout\r\nConnection: close\r\nContent-Type: %b\r\nContent-Length: %d\r\n\r\n%b"
)
_problem = problem_response(
    408, "timed-out", "the request did not arrive in time: check the network, then send it again"
).body
TIMED_OUT %= PROBLEM_TYPE.encode(), len(_problem), bytes(_problem)

chance = random.Random()  # noqa: S311
_HEAD_END = re.compile(rb"\n\r?\n")  # as h11 finds it
_BARE_LF = re.compile(rb"(?<!\r)\n")
_LENGTH = re.compile(rb"^content-length:([^\r\n]*)", re.IGNORECASE | re.MULTILINE)
_CODING = re.compile(rb"^transfer-encoding:", re.IGNORECASE | re.MULTILINE)


def raise_open_file_limit() -> None:
    """Raise this process's limit of open files to the most that the system permits."""
    _, most = resource.getrlimit(resource.RLIMIT_NOFILE)
    with contextlib.suppress(ValueError, OSError):  # macOS reports an infinite limit and refuses it
        resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))


class Connections:
    """The open connections of a server: at most ``most``, and at most half of them from one address.

    A proxy's address may have all of them. Beyond a limit, the connection that has waited longest for the
    rest of its request is closed in favour of the new one. If every connection is waiting for a response, the
    new one gets 503.
    """

    def __init__(self, settings: Settings) -> None:
        files, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
        available = (
            files if files != resource.RLIM_INFINITY else settings.connections + ACCEPTED + OTHER_FILES
        )
        self.most = max(8, min(settings.connections, available - ACCEPTED - OTHER_FILES))
        self.header_s, self.body_s = settings.header_timeout, settings.body_timeout
        self._open: dict[Connection, str] = {}
        self._per_address: Counter[str] = Counter()
        self._idle: dict[Connection, None] = {}  # oldest first
        self._uploading: dict[Connection, None] = {}

    def add(self, connection: "Connection", address: str, *, proxy: bool) -> bool:
        """Add a connection, if need be instead of another one. Return False if there is no place for it."""
        if not proxy and self._per_address[address] >= self.most // 2 and not self._evict(address):
            return False
        if len(self._open) >= self.most and not self._evict(None):
            return False
        self._open[connection] = address
        self._per_address[address] += 1
        return True

    def remove(self, connection: "Connection") -> None:
        """Remove a connection. No effect if it is not present."""
        self.waits(connection, None)
        if (address := self._open.pop(connection, None)) is not None:
            self._per_address[address] -= 1
            if not self._per_address[address]:
                del self._per_address[address]

    def waits(self, connection: "Connection", state: type[h11.IDLE] | type[h11.SEND_BODY] | None) -> None:
        """Record that a connection waits for a header (IDLE), for a body (SEND_BODY) or for no input."""
        self._idle.pop(connection, None)
        self._uploading.pop(connection, None)
        if connection in self._open and state is not None:
            (self._idle if state is h11.IDLE else self._uploading)[connection] = None

    def _evict(self, address: str | None) -> bool:
        for waiting in (self._idle, self._uploading):
            for connection in waiting:
                if address is None or self._open[connection] == address:
                    self.remove(connection)
                    connection.close_for("connections")
                    return True
        return False


class StrictParser(h11.Connection):
    """h11's parser, which refuses the request heads that other HTTP servers and proxies may delimit
    differently.

    These are a bare line feed, a Content-Length that is repeated or a list, and Content-Length with
    Transfer-Encoding.
    """

    def next_event(self) -> Any:
        """Return the next event. Raises RemoteProtocolError as h11 does, and for such a head."""
        if self.their_state is h11.IDLE:
            received, _ = self.trailing_data
            if (end := _HEAD_END.search(received)) is not None:
                _check_head(received[: end.end()])
        return super().next_event()


def _check_head(head: bytes) -> None:
    lengths = _LENGTH.findall(head)
    if _BARE_LF.search(head):
        raise h11.RemoteProtocolError("line feed without carriage return")
    if len(lengths) > 1 or any(not length.strip(b" \t").isdigit() for length in lengths):
        raise h11.RemoteProtocolError("more than one Content-Length")
    if lengths and _CODING.search(head):
        raise h11.RemoteProtocolError("Content-Length with Transfer-Encoding")


class Connection(H11Protocol):
    """One connection. Its request's header must be complete ``header_timeout`` seconds after the connection
    was opened or the previous response ended. Its body may then take ``body_timeout`` seconds and one more
    for every LOWEST_RATE bytes.
    """

    def __init__(self, *, connections: Connections, **arguments: Any) -> None:
        super().__init__(**arguments)
        self.conn = StrictParser(h11.SERVER)
        self._all = connections
        self._phase: tuple[object, object] = (None, None)
        self._deadline: asyncio.TimerHandle | None = None
        self._began, self._received = 0.0, 0

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Start the header's deadline, or refuse the connection."""
        super().connection_made(transport)
        peer = self.client[0] if self.client else ""
        if self._all.add(self, network(peer), proxy=_is_proxy(self.app, peer)):
            self._follow()
        else:
            CLOSED.labels("connections").inc()
            transport.write(REFUSED)
            transport.close()

    def connection_lost(self, exc: Exception | None) -> None:
        """Stop counting the connection."""
        self._all.remove(self)
        self._stop_deadline()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Count and parse the bytes."""
        self._received += len(data)
        super().data_received(data)

    def handle_events(self) -> None:
        """Handle what has been received, and set the deadline of what must follow."""
        super().handle_events()
        self._follow()

    def close_for(self, limit: str) -> None:
        """Close the connection because of ``limit``, with 408 if a request has begun and has no response
        yet.
        """
        self._stop_deadline()
        if self.transport.is_closing():
            return
        CLOSED.labels(limit).inc()
        if self.conn.our_state in (h11.IDLE, h11.SEND_RESPONSE) and self._received:
            self.transport.write(TIMED_OUT)
        if self.cycle is not None and not self.cycle.response_complete:
            self.cycle.disconnected = True
            self.cycle.message_event.set()
        self.transport.close()

    def _follow(self) -> None:
        """Set the deadline of the part of the request that the client must send now, once per part."""
        state = self.conn.their_state
        if (phase := (state, self.cycle)) == self._phase:
            return
        self._phase = phase
        self._stop_deadline()
        if self.transport.is_closing():
            return
        if state is h11.IDLE or state is h11.SEND_BODY:
            self._all.waits(self, state)
            self._start_deadline()
        else:
            self._all.waits(self, None)

    def _start_deadline(self) -> None:
        self._began, self._received = self.loop.time(), 0
        seconds = self._all.header_s if self.conn.their_state is h11.IDLE else self._all.body_s
        # closing and opening thousands at the same moment would delay everybody
        spread = 1.0 + SPREAD * chance.random()
        self._deadline = self.loop.call_later(seconds * spread, self._check_deadline)

    def _check_deadline(self) -> None:
        if self.conn.their_state is h11.IDLE:
            self.close_for("header")
        elif self.flow.read_paused or self.cycle.waiting_for_100_continue:
            self._start_deadline()  # the client waits for the application
        elif (left := self._began + self._all.body_s + self._received / LOWEST_RATE - self.loop.time()) > 0:
            self._deadline = self.loop.call_later(left, self._check_deadline)
        else:
            self.close_for("body")

    def _stop_deadline(self) -> None:
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None


def _is_proxy(app: ASGIApp | Any, peer: str) -> bool:
    return isinstance(app, ProxyHeadersMiddleware) and peer in app.trusted_hosts
