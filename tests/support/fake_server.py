"""Doubles for talking HTTP: a real server on loopback that answers by a script, and a browser that really
fetches.
"""

import asyncio
import json
import ssl
import threading
import time
import types
import urllib.error
import urllib.request
from collections.abc import Callable
from http.client import IncompleteRead
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import NamedTuple

MOST_READ = 2**20  # a longer body stays unread


class Seen(NamedTuple):
    method: str
    path: str
    headers: dict[str, str]
    body: bytes


class Scripted:
    """``script`` holds what is done with one request after the other;
    the last of it is done again and again.
    """

    def __init__(self, tls: ssl.SSLContext | None = None) -> None:
        self.script: list[Callable[[BaseHTTPRequestHandler], None]] = []
        self.seen: list[Seen] = []
        self._turn = threading.Lock()
        self._server = _Quiet(("127.0.0.1", 0), self._handler())
        if tls:
            self._server.socket = tls.wrap_socket(self._server.socket, server_side=True)
        self.port = self._server.server_address[1]
        self.url = f"http{'s' if tls else ''}://127.0.0.1:{self.port}"
        self._thread = threading.Thread(target=self._server.serve_forever, kwargs={"poll_interval": 0.01})
        self._thread.start()

    def stop(self) -> None:
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()

    def _handler(scripted) -> type[BaseHTTPRequestHandler]:
        class Handler(BaseHTTPRequestHandler):
            def do(self) -> None:
                length = int(self.headers.get("Content-Length", 0))
                body = self.rfile.read(length) if length < MOST_READ else b""
                headers = {name.lower(): value for name, value in self.headers.items()}
                with scripted._turn:
                    step = scripted.script[min(len(scripted.seen), len(scripted.script) - 1)]
                    scripted.seen.append(Seen(self.command, self.path, headers, body))
                step(self)

            do_GET = do_POST = do

            def log_message(self, *_: object) -> None:
                pass

        return Handler


class _Quiet(ThreadingHTTPServer):
    daemon_threads = True

    def handle_error(self, *_: object) -> None:
        pass  # a connection that the test cuts


def says(status=200, body=b"{}", kind="application/json", **headers):
    """One whole answer; a dictionary goes as JSON, and header names are written with _ for -."""

    def step(handler):
        sent = json.dumps(body).encode() if isinstance(body, dict) else body
        handler.send_response(status)
        for name, value in {"Content-Type": kind, "Content-Length": str(len(sent)), **headers}.items():
            handler.send_header(name.replace("_", "-"), value)
        handler.end_headers()
        handler.wfile.write(sent)

    return step


def problem(status, kind, detail, **headers):
    document = {"type": f"urn:polhode:problem:{kind}", "title": "T", "status": status, "detail": detail}
    return says(status, document, "application/problem+json", **headers)


def cuts(handler):
    """An answer that breaks off."""
    handler.send_response(200)
    handler.send_header("Content-Type", "application/json")
    handler.send_header("Content-Length", "100")
    handler.end_headers()
    handler.wfile.write(b'{"half":')


def hangs_up(handler):
    handler.connection.close()


def streams(*parts):
    """Server-sent events, given as bytes; a number is a pause in seconds."""

    def step(handler):
        handler.send_response(200)
        handler.send_header("Content-Type", "text/event-stream; charset=utf-8")
        handler.end_headers()
        for part in parts:
            if isinstance(part, bytes):
                handler.wfile.write(part)
                handler.wfile.flush()
            else:
                time.sleep(part)

    return step


def event(name, id, **data):
    return f"event: {name}\nid: {id}\ndata: {json.dumps({'status': name, **data})}\n\n".encode()


class JsException(Exception):
    def __init__(self, name: str, message: str = "") -> None:
        super().__init__(f"{name}: {message}")
        self.name, self.message = name, message


def browser(*, waits: bool) -> dict[str, types.ModuleType]:
    """``js`` and ``pyodide`` as a kernel finds them in a web worker; with ``waits`` Python can wait for
    promises there.
    """
    js, pyodide, ffi, http = (
        types.ModuleType(name) for name in ("js", "pyodide", "pyodide.ffi", "pyodide.http")
    )
    js.XMLHttpRequest = _Request
    ffi.JsException, ffi.to_js, ffi.can_run_sync = JsException, _Buffer, lambda: waits
    ffi.run_sync, http.pyfetch = asyncio.run, _pyfetch
    return {"js": js, "pyodide": pyodide, "pyodide.ffi": ffi, "pyodide.http": http}


class _Buffer:
    """A JavaScript buffer: bytes only by ``to_bytes``."""

    def __init__(self, content: bytes) -> None:
        self._content = content

    def to_bytes(self) -> bytes:
        return self._content


class _Request:
    """XMLHttpRequest, synchronous, as workers have it."""

    new: Callable[[], "_Request"]
    status, response, responseURL, timeout, responseType = 0, None, "", 0, ""

    def open(self, method: str, url: str, is_async: bool) -> None:
        assert is_async is False
        self._opened, self._headers = (method, url), {}

    def setRequestHeader(self, name: str, value: str) -> None:
        self._headers[name] = value

    def send(self, body: _Buffer | None = None) -> None:
        content = body.to_bytes() if body is not None else None
        try:
            got = _really(*self._opened, content, self._headers, self.timeout / 1000)
        except TimeoutError:
            raise JsException("TimeoutError", "the request timed out") from None
        except OSError:
            raise JsException("NetworkError", "A network error occurred.") from None
        assert self.responseType == "arraybuffer"
        self.status, self._all, self.response, self.responseURL = got[0], got[1], _Buffer(got[2]), got[3]

    def getAllResponseHeaders(self) -> str:
        return "".join(f"{name.lower()}: {value}\r\n" for name, value in self._all.items())


_Request.new = _Request


async def _pyfetch(url, *, method, headers, cache, body=None):
    """A body that is cut off is noticed when it is read."""
    try:
        status, told, content, at = await asyncio.to_thread(_really, method, url, body, headers, 5.0)
    except _CutOff:
        status, told, content, at = 200, {}, None, url
    except OSError:
        raise OSError("Failed to fetch") from None

    async def buffer():
        if content is None:
            raise JsException("TypeError", "network error")
        return _Buffer(content)

    js_response = types.SimpleNamespace(arrayBuffer=buffer)
    return types.SimpleNamespace(
        status=status, headers={k.lower(): v for k, v in told.items()}, js_response=js_response, url=at
    )


class _CutOff(ConnectionError):
    pass


def _really(method, url, body, headers, timeout):
    """What a browser does: it follows redirects, without the token where they lead to another origin."""
    assert "user-agent" not in {name.lower() for name in headers}
    request = urllib.request.Request(url, body, method=method)
    for name, value in headers.items():
        add = request.add_unredirected_header if name.lower() == "authorization" else request.add_header
        add(name, value)
    try:
        with urllib.request.urlopen(request, timeout=timeout) as response:
            return response.status, dict(response.headers), _all(response), response.url
    except urllib.error.HTTPError as error:
        with error:
            return error.code, dict(error.headers), error.read(), error.url
    except urllib.error.URLError as error:
        raise error.reason from None


def _all(response):
    try:
        return response.read()
    except IncompleteRead:
        raise _CutOff from None
