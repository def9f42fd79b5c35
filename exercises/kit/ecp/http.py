"""One request and its answer, by whichever back end there is; errors are exceptions that explain themselves."""

import random
import sys
import time
from collections.abc import Generator, Iterator, Mapping
from contextlib import closing
from typing import NamedTuple
from urllib.parse import urljoin

from ecp.errors import (
    Answer,
    Backend,
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
from ecp.sse import Event, parsed

AGENT = f"polhode-kit/1 python/{sys.version_info.major}.{sys.version_info.minor}"
REDIRECTS, MOST_REDIRECTS = (301, 302, 303, 307, 308), 5


class Request(NamedTuple):
    """A request. Header names are lower-case."""

    method: str
    url: str
    body: bytes | None
    headers: dict[str, str]


def asked(method: str, url: str, body: bytes | None, headers: Mapping[str, str] | None) -> Request:
    """A request that can be sent. A header that cannot is named, but not shown: it may be the token."""
    own = {name.lower(): value.strip() for name, value in (headers or {}).items()}
    for name, value in own.items():
        if not (value.isascii() and value.isprintable()):
            what = "Your token" if name == "authorization" else f"The header {name}"
            raise Unreachable(f"{what} has a character that cannot be sent: copy it again, in one line.", passing=False)
    return Request(method, checked(url), body, {"user-agent": AGENT, "accept": "application/json"} | own)


def answered(request: Request, timeout: float) -> Answer:
    """The answer of a polhode server; Unreachable or HTTPError if there is none or it is an error."""
    answer = _followed(request, timeout)
    if answer.status >= 400:
        raise refusal(answer, request.url, request.headers)
    if is_page(answer) and "html" not in request.headers["accept"]:
        raise not_polhode(answer, request.url)
    return answer


def streamed(request: Request, last: str, silence: float) -> Generator[Event, None, None]:
    """What the stream tells after the event ``last`` until it ends or fails, or nothing: an ordinary request will tell why."""
    headers = request.headers | {"accept": "text/event-stream"} | ({"last-event-id": last} if last else {})
    try:
        chunks = _backend().stream(request.url, headers, silence)
        if chunks is not None:
            yield from parsed(chunks)
    except Unreachable:
        return


def _followed(request: Request, timeout: float) -> Answer:
    """The answer after redirects within one origin, to which the same request goes again (303: a GET)."""
    backend = _backend()
    for _ in range(MOST_REDIRECTS):
        answer = backend.request(*request, timeout)
        if answer.status not in REDIRECTS:
            return answer
        target = checked(urljoin(request.url, answer.headers.get("location", "")))
        if not same_origin(target, request.url):
            raise moved(answer.status, request.url, target)
        request = request._replace(url=target)
        if answer.status == 303:
            request = request._replace(method="GET", body=None)
    raise HTTPError(
        answer.status, "moved", f"The server at {place(request.url)} sends us round in circles: tell your course staff."
    )


def _backend() -> Backend:
    if sys.platform == "emscripten":
        from ecp.pyodide import Browser

        return Browser()
    from ecp.http_sockets import Sockets

    return Sockets()


__all__ = ["Answer", "Event", "HTTPError", "RequestError", "Unreachable", "call", "events"]

CONTACT_S = 15.0  # patience with a server that was not there yet
FINAL = ("graded", "faulted")
SHORTEST_WAIT_S, FIRST_PAUSE_S, LONGEST_PAUSE_S = 0.1, 0.5, 16.0
chance = random.Random()  # noqa: S311  a student's own random.seed() stays untouched


def call(
    method: str,
    url: str,
    *,
    body: bytes | None = None,
    headers: Mapping[str, str] | None = None,
    timeout: float = 30.0,
    patience: float = 60.0,
) -> Answer:
    """The answer, if it is not an error; else Unreachable or HTTPError.

    A lost connection, 429, 502, 503 and 504 are tried again with the same headers until ``patience`` seconds are over, so give a
    POST an ``Idempotency-Key``. One attempt may take ``timeout`` seconds, also the last.
    """
    return _patiently(asked(method, url, body, headers), timeout, patience, forgiving=False)


def events(
    url: str, *, headers: Mapping[str, str] | None = None, patience: float = 60.0, silence: float = 20.0, pause: float = 1.0
) -> Iterator[Event]:
    """Follow a submission by its ``…/events`` until ``graded`` or ``faulted``, whatever happens to the connection meanwhile.

    Whenever the stream ends, is silent for ``silence`` seconds or cannot be had, the submission itself is asked for, then the
    stream again after ``pause`` seconds (slowly growing to three times that). What was asked for is an event with only its status.
    """
    request = asked("GET", url, None, headers)
    last, told, wait = "", "", pause
    while told not in FINAL:
        with closing(streamed(request, last, silence)) as stream:
            for event in stream:
                yield event
                last, told, wait = event.id or last, event.name, pause
                if told in FINAL:
                    return
        status = _status(request, patience, forgiving=bool(told))
        if status != told:
            yield Event(status, "", {"status": status})
            told, wait = status, pause
        if told not in FINAL:
            time.sleep(wait * chance.uniform(1.0, 1.25))
            wait = min(1.5 * wait, 3 * pause)


def _status(following: Request, patience: float, *, forgiving: bool) -> str:
    request = following._replace(url=following.url.removesuffix("/events"))
    answer = _patiently(request, 30.0, patience, forgiving=forgiving)
    document = answer.json()
    if not isinstance(document, dict) or not isinstance(document.get("status"), str):
        raise not_polhode(answer, request.url)
    status: str = document["status"]
    return status


def _patiently(request: Request, timeout: float, patience: float, *, forgiving: bool) -> Answer:
    """``forgiving``: the server was there before, so no trouble of the network is taken to last."""
    until, pause = time.monotonic() + patience, FIRST_PAUSE_S
    while True:
        try:
            return answered(request, timeout)
        except RequestError as trouble:
            told = pause if trouble.wait_s is None else max(trouble.wait_s, SHORTEST_WAIT_S)
            wait = told * chance.uniform(1.0, 1.25)
            lasting = not trouble.passing and not (forgiving and isinstance(trouble, Unreachable))
            if lasting or time.monotonic() + wait > until:
                raise
        time.sleep(wait)
        pause = min(2 * pause, LONGEST_PAUSE_S)
