"""Requests through the browser, for a kernel in a web page (JupyterLite), which has no sockets.

Where Python can wait for a promise (WebAssembly stack switching: Chrome, Edge) the request uses ``fetch``,
elsewhere a synchronous XMLHttpRequest, which a web worker may use. The browser follows redirects itself and
removes the token for another origin.
"""

import asyncio
from collections.abc import Iterable, Mapping
from importlib import import_module
from typing import Any

from polhode.client.errors import MOST_BYTES, Answer, Unreachable, moved, place, same_origin, too_long

OWN = ("user-agent",)  # browsers drop it, reject it, or send a preflight request for it


def request(method: str, url: str, body: bytes | None, headers: Mapping[str, str], timeout: float) -> Answer:
    """Return the answer. Raises Unreachable if there is none or the browser blocks it; the browser does not
    say which. Header names are lower case.
    """
    sent = {name: value for name, value in headers.items() if name not in OWN}
    try:
        if _can_wait():
            fetching = asyncio.wait_for(_fetch(method, url, body, sent), timeout)
            answer, final = import_module("pyodide.ffi").run_sync(fetching)
        else:
            answer, final = _synchronous(method, url, body, sent, timeout)
    except (OSError, import_module("pyodide.ffi").JsException) as error:
        raise _unreachable(error, url, timeout) from None
    if final and not same_origin(final, url):
        raise moved(answer.status, url, final)
    if len(answer.body) > MOST_BYTES:
        raise too_long(url)
    return answer


def stream(url: str, headers: Mapping[str, str], silence: float) -> Iterable[bytes]:
    """Return nothing: a synchronous request returns its answer only when it is complete."""
    return ()


def _can_wait() -> bool:
    try:
        return bool(import_module("pyodide.ffi").can_run_sync())
    except (ImportError, AttributeError):  # Pyodide before 0.27
        return False


async def _fetch(method: str, url: str, body: bytes | None, sent: dict[str, str]) -> tuple[Answer, str]:
    """Return the answer and its address after redirects."""
    options: dict[str, Any] = {"method": method, "headers": sent, "cache": "no-store"} | (
        {} if body is None else {"body": body}
    )
    response = await import_module("pyodide.http").pyfetch(url, **options)
    headers = {name.lower(): value for name, value in dict(response.headers).items()}
    whole = (
        await response.js_response.arrayBuffer()
    )  # response.bytes() of Pyodide 314 fails by itself if this is cut off
    return Answer(response.status, headers, whole.to_bytes()), response.url


def _synchronous(
    method: str, url: str, body: bytes | None, sent: dict[str, str], timeout: float
) -> tuple[Answer, str]:
    """Return the answer and its address after redirects."""
    xhr = import_module("js").XMLHttpRequest.new()
    xhr.open(method, url, False)
    xhr.responseType = "arraybuffer"
    xhr.timeout = int(1000 * timeout)
    for name, value in sent.items():
        xhr.setRequestHeader(name, value)
    xhr.send(*([] if body is None else [import_module("pyodide.ffi").to_js(body)]))
    if xhr.status == 0:
        raise ConnectionError
    lines = (line.partition(":") for line in xhr.getAllResponseHeaders().splitlines())
    headers = {name.strip().lower(): value.strip() for name, _, value in lines}
    return Answer(xhr.status, headers, xhr.response.to_bytes()), xhr.responseURL


def _unreachable(error: Exception, url: str, timeout: float) -> Unreachable:
    if isinstance(error, TimeoutError) or getattr(error, "name", "") == "TimeoutError":
        return Unreachable(
            f"{place(url)} did not answer within {timeout:g} s: check your network and try again."
        )
    return Unreachable(
        f"Your browser did not reach {place(url)}: check the address and your network; if both are right, the"
        " server does not accept requests from this page, so ask your course staff."
    )
