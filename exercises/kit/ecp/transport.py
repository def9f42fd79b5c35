"""HTTP from any kernel to a polhode server: requests that outlast a bad network, and a submission followed to its result.

CPython uses its sockets (``ecp.sockets``), a kernel in a web page the browser (``ecp.pyodide``).
"""

import random
import time
from collections.abc import Iterator, Mapping
from contextlib import closing

from ecp.answers import Answer, Refused, Trouble, Unreachable
from ecp.exchange import Asked, answered, asked, streamed
from ecp.refusals import not_polhode
from ecp.sse import Event

__all__ = ["Answer", "Event", "Refused", "Trouble", "Unreachable", "call", "events"]

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
    """The answer, if it is not an error; else Unreachable or Refused.

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


def _status(following: Asked, patience: float, *, forgiving: bool) -> str:
    request = following._replace(url=following.url.removesuffix("/events"))
    answer = _patiently(request, 30.0, patience, forgiving=forgiving)
    document = answer.json()
    if not isinstance(document, dict) or not isinstance(document.get("status"), str):
        raise not_polhode(answer, request.url)
    status: str = document["status"]
    return status


def _patiently(request: Asked, timeout: float, patience: float, *, forgiving: bool) -> Answer:
    """``forgiving``: the server was there before, so no trouble of the network is taken to last."""
    until, pause = time.monotonic() + patience, FIRST_PAUSE_S
    while True:
        try:
            return answered(request, timeout)
        except Trouble as trouble:
            told = pause if trouble.wait_s is None else max(trouble.wait_s, SHORTEST_WAIT_S)
            wait = told * chance.uniform(1.0, 1.25)
            lasting = not trouble.passing and not (forgiving and isinstance(trouble, Unreachable))
            if lasting or time.monotonic() + wait > until:
                raise
        time.sleep(wait)
        pause = min(2 * pause, LONGEST_PAUSE_S)
