"""Requests through the browser, for a kernel in a web page (JupyterLite), which has no sockets.

Where Python can wait for a promise (WebAssembly stack switching: Chrome, Edge) the request uses ``fetch``,
elsewhere a synchronous XMLHttpRequest, which a web worker may use. The browser follows redirects itself and
removes the token for another origin.
"""

import asyncio
from collections.abc import Iterator, Mapping
from importlib import import_module
from typing import Any, NamedTuple

from ecp.errors import MOST_BYTES, Answer, Unreachable, moved, place, same_origin, too_long

OWN = ("user-agent",)  # browsers drop it, reject it, or send a preflight request for it


class Browser:
    """The back end of a kernel in a web worker."""

    def request(self, method: str, url: str, body: bytes | None, headers: Mapping[str, str], timeout: float) -> Answer:
        """Return the answer. Raises Unreachable if there is none or the browser blocks it; the browser does
        not say which.
        """
        sent = {name: value for name, value in headers.items() if name not in OWN}
        how = _fetch if _can_wait() else _synchronous
        try:
            got = how(_Asked(method, url, body, sent, timeout))
        except (OSError, import_module("pyodide.ffi").JsException) as error:
            raise _unreachable(error, url, timeout) from None
        if got.at and not same_origin(got.at, url):
            raise moved(got.answer.status, url, got.at)
        if len(got.answer.body) > MOST_BYTES:
            raise too_long(url)
        return got.answer

    def stream(self, url: str, headers: Mapping[str, str], silence: float) -> Iterator[bytes] | None:
        """Return None: a synchronous request returns its answer only when it is complete."""
        return None


class _Asked(NamedTuple):
    method: str
    url: str
    body: bytes | None
    headers: dict[str, str]
    timeout: float


class _Got(NamedTuple):
    answer: Answer
    at: str  # the address after redirects


def _can_wait() -> bool:
    try:
        return bool(import_module("pyodide.ffi").can_run_sync())
    except (ImportError, AttributeError):  # Pyodide before 0.27
        return False


def _fetch(asked: _Asked) -> _Got:
    got: _Got = import_module("pyodide.ffi").run_sync(asyncio.wait_for(_fetched(asked), asked.timeout))
    return got


async def _fetched(asked: _Asked) -> _Got:
    options: dict[str, Any] = {"method": asked.method, "headers": asked.headers, "cache": "no-store"}
    if asked.body is not None:
        options["body"] = asked.body
    response = await import_module("pyodide.http").pyfetch(asked.url, **options)
    headers = {name.lower(): value for name, value in dict(response.headers).items()}
    body = await response.js_response.arrayBuffer()  # response.bytes() of Pyodide 314 fails by itself if this is cut off
    return _Got(Answer(response.status, headers, body.to_bytes()), response.url)


def _synchronous(asked: _Asked) -> _Got:
    xhr = import_module("js").XMLHttpRequest.new()
    xhr.open(asked.method, asked.url, False)
    xhr.responseType = "arraybuffer"
    xhr.timeout = int(1000 * asked.timeout)
    for name, value in asked.headers.items():
        xhr.setRequestHeader(name, value)
    if asked.body is None:
        xhr.send()
    else:
        xhr.send(import_module("pyodide.ffi").to_js(asked.body))
    if xhr.status == 0:
        raise ConnectionError
    lines = (line.partition(":") for line in xhr.getAllResponseHeaders().splitlines())
    headers = {name.strip().lower(): value.strip() for name, _, value in lines}
    return _Got(Answer(xhr.status, headers, xhr.response.to_bytes()), xhr.responseURL)


def _unreachable(error: Exception, url: str, timeout: float) -> Unreachable:
    if isinstance(error, TimeoutError) or getattr(error, "name", "") == "TimeoutError":
        return Unreachable(f"{place(url)} did not answer within {timeout:g} s: check your network and try again.")
    return Unreachable(
        f"Your browser did not reach {place(url)}: check the address and your network; if both are right, the server does not "
        "accept requests from this page, so ask your course staff."
    )
