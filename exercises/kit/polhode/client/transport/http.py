"""Requests to the course server, retried while a failure may pass. Errors are exceptions with a message for
the student.
"""

import random
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import closing
from importlib import import_module
from typing import Any, NamedTuple
from urllib.parse import urljoin

from polhode import KIT
from polhode.client.errors import (
    Answer,
    HTTPError,
    RequestError,
    Unreachable,
    checked,
    is_page,
    moved,
    not_polhode,
    place,
    refusal,
    same_origin,
)
from polhode.client.transport.sse import Event, parse_events

__all__ = ["Answer", "Event", "HTTPError", "RequestError", "Unreachable", "call", "events"]

AGENT = f"polhode-kit/{KIT} python/{sys.version_info.major}.{sys.version_info.minor}"
REDIRECTS, MOST_REDIRECTS = (301, 302, 303, 307, 308), 5
CONTACT_S = 15.0  # patience with a server that has not answered yet
FINAL = ("graded", "faulted")
SHORTEST_WAIT_S, FIRST_PAUSE_S, LONGEST_PAUSE_S = 0.1, 0.5, 16.0
chance = random.Random()  # noqa: S311  a student's own random.seed() stays untouched


class Request(NamedTuple):
    """A request. Header names are lower-case."""

    method: str
    url: str
    body: bytes | None
    headers: dict[str, str]


def prepare(method: str, url: str, body: bytes | None, headers: Mapping[str, str] | None) -> Request:
    """Return a request that can be sent. Raises Unreachable for a bad address or header.

    The message names a bad header but does not show its value, which may be the token.
    """
    own = {name.lower(): value.strip() for name, value in (headers or {}).items()}
    for name, value in own.items():
        if not (value.isascii() and value.isprintable()):
            what = "Your token" if name == "authorization" else f"The header {name}"
            raise Unreachable(
                f"{what} has a character that cannot be sent: copy it again, as one line.", passing=False
            )
    return Request(method, checked(url), body, {"user-agent": AGENT, "accept": "application/json"} | own)


def send(request: Request, timeout: float) -> Answer:
    """Return the answer of a polhode server. Raises Unreachable if there is none, HTTPError if it is an
    error.
    """
    answer = _follow_redirects(request, timeout)
    if answer.status >= 400:
        raise refusal(answer, request.url, request.headers)
    if is_page(answer) and "html" not in request.headers["accept"]:
        raise not_polhode(answer, request.url)
    return answer


def _follow_redirects(request: Request, timeout: float) -> Answer:
    """Return the answer after redirects within one origin. The request is repeated there; after a 303 as a
    GET.
    """
    backend = _backend()
    for _ in range(MOST_REDIRECTS):
        answer: Answer = backend.request(*request, timeout)
        if answer.status not in REDIRECTS:
            return answer
        target = checked(urljoin(request.url, answer.headers.get("location", "")))
        if not same_origin(target, request.url):
            raise moved(answer.status, request.url, target)
        request = request._replace(url=target)
        if answer.status == 303:
            request = request._replace(method="GET", body=None)
    raise HTTPError(
        answer.status, "moved", f"Too many redirects from {place(request.url)}: ask your course staff."
    )


def _backend() -> Any:
    """Return the module that sends requests: both have ``request`` and ``stream``."""
    name = "pyodide" if sys.platform == "emscripten" else "sockets"
    return import_module(f"polhode.client.transport.{name}")


def call(
    method: str,
    url: str,
    *,
    body: bytes | None = None,
    headers: Mapping[str, str] | None = None,
    timeout: float = 30.0,
    patience: float = 60.0,
) -> Answer:
    """Send a request and return the answer. Raises Unreachable if there is none, HTTPError if it is an error.

    A lost connection, 429, 502, 503 and 504 are retried with the same headers until ``patience`` seconds have
    passed, so give a POST an ``Idempotency-Key``. Each try, the last one included, may take ``timeout``
    seconds.
    """
    return _retry(prepare(method, url, body, headers), timeout, patience, reached=False)


def events(
    url: str,
    *,
    headers: Mapping[str, str] | None = None,
    patience: float = 60.0,
    silence: float = 20.0,
    pause: float = 1.0,
) -> Iterator[Event]:
    """Yield a submission's events from its ``…/events`` until ``graded`` or ``faulted``, across lost
    connections.

    Whenever the stream ends, is silent for ``silence`` seconds or is not available, the submission itself is
    requested, and the stream again after ``pause`` seconds (growing to three times that). A requested status
    becomes an event without other data. Raises like ``call``.
    """
    request = prepare("GET", url, None, headers)
    last, known, wait = "", "", pause
    while known not in FINAL:
        headers = (
            request.headers | {"accept": "text/event-stream"} | ({"last-event-id": last} if last else {})
        )
        with closing(parse_events(_backend().stream(request.url, headers, silence))) as received:
            for event in received:
                yield event
                last, known, wait = event.id or last, event.name, pause
                if known in FINAL:
                    return
        status = _status(request, patience, reached=bool(known))
        if status != known:
            yield Event(status, "", {"status": status})
            known, wait = status, pause
        if known not in FINAL:
            time.sleep(wait * chance.uniform(1.0, 1.25))
            wait = min(1.5 * wait, 3 * pause)


def _status(following: Request, patience: float, *, reached: bool) -> str:
    request = following._replace(url=following.url.removesuffix("/events"))
    answer = _retry(request, 30.0, patience, reached=reached)
    document = answer.json()
    if not isinstance(document, dict) or not isinstance(document.get("status"), str):
        raise not_polhode(answer, request.url)
    status: str = document["status"]
    return status


def _retry(request: Request, timeout: float, patience: float, *, reached: bool) -> Answer:
    """Send until it succeeds or ``patience`` is over. If the server was ``reached`` before, every network
    error may pass.
    """
    until, pause = time.monotonic() + patience, FIRST_PAUSE_S
    while True:
        try:
            return send(request, timeout)
        except RequestError as error:
            least = pause if error.wait_s is None else max(error.wait_s, SHORTEST_WAIT_S)
            wait = least * chance.uniform(1.0, 1.25)
            lasting = not error.passing and not (reached and isinstance(error, Unreachable))
            if lasting or time.monotonic() + wait > until:
                raise
        time.sleep(wait)
        pause = min(2 * pause, LONGEST_PAUSE_S)
