"""One request and its answer, by whichever back end there is; errors are exceptions that explain themselves."""

import sys
from collections.abc import Generator, Mapping
from typing import NamedTuple
from urllib.parse import urljoin

from ecp.answers import Answer, Backend, Refused, Unreachable, checked, moved, place, same_origin
from ecp.refusals import is_page, not_polhode, refusal
from ecp.sse import Event, parsed

AGENT = f"polhode-kit/1 python/{sys.version_info.major}.{sys.version_info.minor}"
REDIRECTS, MOST_REDIRECTS = (301, 302, 303, 307, 308), 5


class Asked(NamedTuple):
    """A request. Header names are lower-case."""

    method: str
    url: str
    body: bytes | None
    headers: dict[str, str]


def asked(method: str, url: str, body: bytes | None, headers: Mapping[str, str] | None) -> Asked:
    """A request that can be sent. A header that cannot is named, but not shown: it may be the token."""
    own = {name.lower(): value.strip() for name, value in (headers or {}).items()}
    for name, value in own.items():
        if not (value.isascii() and value.isprintable()):
            what = "Your token" if name == "authorization" else f"The header {name}"
            raise Unreachable(f"{what} has a character that cannot be sent: copy it again, in one line.", passing=False)
    return Asked(method, checked(url), body, {"user-agent": AGENT, "accept": "application/json"} | own)


def answered(request: Asked, timeout: float) -> Answer:
    """The answer of a polhode server; Unreachable or Refused if there is none or it is an error."""
    answer = _followed(request, timeout)
    if answer.status >= 400:
        raise refusal(answer, request.url, request.headers)
    if is_page(answer) and "html" not in request.headers["accept"]:
        raise not_polhode(answer, request.url)
    return answer


def streamed(request: Asked, last: str, silence: float) -> Generator[Event, None, None]:
    """What the stream tells after the event ``last`` until it ends or fails, or nothing: an ordinary request will tell why."""
    headers = request.headers | {"accept": "text/event-stream"} | ({"last-event-id": last} if last else {})
    try:
        chunks = _backend().stream(request.url, headers, silence)
        if chunks is not None:
            yield from parsed(chunks)
    except Unreachable:
        return


def _followed(request: Asked, timeout: float) -> Answer:
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
    raise Refused(answer.status, "moved", f"The server at {place(request.url)} sends us round in circles: tell your course staff.")


def _backend() -> Backend:
    if sys.platform == "emscripten":
        from ecp.pyodide import Browser

        return Browser()
    from ecp.sockets import Sockets  # imports ssl, which a kernel in a web page may lack

    return Sockets()
