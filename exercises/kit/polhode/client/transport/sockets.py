"""Requests by the standard library, for every Python that has sockets."""

import errno
import ssl
import time
from collections.abc import Iterator, Mapping
from contextlib import suppress
from http.client import BadStatusLine, HTTPConnection, HTTPException, HTTPResponse, RemoteDisconnected
from ipaddress import ip_address
from socket import EAI_NONAME, gaierror
from typing import Any
from urllib.error import URLError
from urllib.parse import urlsplit
from urllib.request import HTTPErrorProcessor, HTTPHandler, HTTPSHandler, ProxyHandler, Request, build_opener

from polhode.client.errors import MOST_BYTES, Answer, Unreachable, place, too_long

CHUNK = 2**16
NO_NETWORK = (errno.ENETUNREACH, errno.EHOSTUNREACH, errno.ENETDOWN)


def request(method: str, url: str, body: bytes | None, headers: Mapping[str, str], timeout: float) -> Answer:
    """Return the answer, a redirect too, read completely within ``timeout`` seconds of its first byte. Raises
    Unreachable if there is none. Header names are lower case.
    """
    try:
        with _open(Request(url, body, dict(headers), method=method), timeout) as response:  # noqa: S310
            return Answer(
                response.status, _lower(response), _whole(response, url, time.monotonic() + timeout)
            )
    except (OSError, HTTPException) as error:
        raise unreachable(error, url, timeout) from None


def stream(url: str, headers: Mapping[str, str], silence: float) -> Iterator[bytes]:
    """Yield the chunks of an event stream as they arrive, until it ends, fails, or is silent for ``silence``
    seconds.
    """
    request = Request(url, None, dict(headers))  # noqa: S310
    with suppress(OSError, HTTPException), _open(request, silence) as response:
        kind = _lower(response).get("content-type", "")
        if response.status == 200 and kind.startswith("text/event-stream"):
            while chunk := response.read1(CHUNK):
                yield chunk


class _AsItIs(HTTPErrorProcessor):
    """Returns errors and redirects like other answers."""

    def http_response(self, request: Request, response: HTTPResponse) -> HTTPResponse:
        return response

    https_response = http_response


class _Connection(HTTPConnection):
    """A connection that reads the answer of a server that closes it before reading the whole body, for
    example with 413.
    """

    def send(self, data: Any) -> None:
        try:
            super().send(data)
        except (BrokenPipeError, ConnectionResetError, ConnectionAbortedError):
            if self.sock is None:
                raise


class _Handler(HTTPHandler, HTTPSHandler):
    def do_open(self, http_class: Any, req: Request, **more: Any) -> HTTPResponse:
        connection: Any = type("Connection", (_Connection, http_class), {})
        return super().do_open(connection, req, **more)


def unreachable(error: Exception, url: str, timeout: float) -> Unreachable:
    """Return the Unreachable error for an exception of the standard library. A wrong name or certificate does
    not pass.
    """
    cause = error.reason if isinstance(error, URLError) and isinstance(error.reason, Exception) else error
    sentence = _why(cause, place(url), urlsplit(url).hostname or "", timeout)
    lasting = isinstance(cause, ssl.SSLCertVerificationError) or (
        isinstance(cause, gaierror) and cause.errno == EAI_NONAME
    )
    return Unreachable(sentence, passing=not lasting)


def _why(cause: Exception, at: str, host: str, timeout: float) -> str:
    match cause:
        case ssl.SSLCertVerificationError():
            sentence = (
                f"The certificate of {at} is not trusted ({cause.verify_message}): check the address and this"
                " computer's clock, then ask your course staff (on a Mac, run “Install Certificates.command”"
                " first)."
            )
        case ssl.SSLError():
            sentence = (
                f"No secure connection to {at}: check whether its address begins with https:// or http://."
            )
        case gaierror():
            sentence = f"The name {host} was not found: check the address and your network."
        case TimeoutError():
            sentence = f"{at} did not answer within {timeout:g} s: check your network and try again."
        case ConnectionRefusedError():
            sentence = (
                f"Nothing answers at {at} (connection refused): check the address, or try again when the"
                " server is up."
            )
        case OSError() if cause.errno in NO_NETWORK:
            sentence = f"There is no network to {at}: check your connection and try again."
        case OSError() if "Tunnel" in str(cause):
            sentence = f"Your network's proxy blocks {at}: check HTTPS_PROXY or use another network."
        case BadStatusLine() if not isinstance(cause, RemoteDisconnected):
            sentence = f"The program at {at} does not speak HTTP: check the address and its port."
        case _:
            sentence = f"The connection to {at} was lost: check your network and try again."
    return sentence


def _open(request: Request, timeout: float) -> HTTPResponse:
    proxies = ProxyHandler({}) if _is_loopback(urlsplit(request.full_url).hostname or "") else ProxyHandler()
    response: HTTPResponse = build_opener(proxies, _AsItIs, _Handler).open(request, timeout=timeout)
    return response


def _is_loopback(host: str) -> bool:
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost" or host.endswith(".localhost")


def _lower(response: HTTPResponse) -> dict[str, str]:
    return {name.lower(): value for name, value in response.headers.items()}


def _whole(response: HTTPResponse, url: str, until: float) -> bytes:
    body = bytearray()
    while chunk := response.read1(CHUNK):
        body += chunk
        if len(body) > MOST_BYTES:
            raise too_long(url)
        if time.monotonic() > until:
            raise TimeoutError
    if response.length:  # read1 does not report a body that ends early
        raise ConnectionResetError
    return bytes(body)
