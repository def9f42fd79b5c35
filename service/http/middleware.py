"""Middleware of every request: request id, log line, metrics and security headers."""

import logging
import time
import uuid

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import ClientDisconnect
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.http.errors import internal_error, problem_response
from service.http.metrics import REQUESTS, SECONDS
from service.http.requests import is_valid_host
from service.logs import request_id

log = logging.getLogger("polhode.access")
CONTENT_SECURITY = (
    "default-src 'self'; img-src 'self' data:; frame-ancestors 'none'; base-uri 'none'; form-action 'self'"
)
# An SVG opened directly is a document with inline styles; it may load and run nothing else.
SVG_CONTENT_SECURITY = (
    "default-src 'none'; style-src 'unsafe-inline'; img-src data:; frame-ancestors 'none'; sandbox"
)
HTTPS_ONLY = "max-age=31536000"  # a year
DISCONNECTED = 499  # status in log and metrics of a request whose client left; nginx's number
METHODS = {"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"}
SECURITY_HEADERS = {
    "content-security-policy": CONTENT_SECURITY,
    "x-content-type-options": "nosniff",
    "referrer-policy": "same-origin",
}


class RequestMiddleware:
    """ASGI middleware. Event streams pass through unbuffered. With ``https``, browsers then use no other
    scheme for this host.
    """

    def __init__(self, app: ASGIApp, *, https: bool = False) -> None:
        self.app = app
        self.headers = SECURITY_HEADERS | ({"strict-transport-security": HTTPS_ONLY} if https else {})

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle one request."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        id, started, status, method = uuid.uuid4().hex[:16], time.perf_counter(), 0, scope["method"]
        token = request_id.set(id)
        if method == "HEAD":  # handled as GET; the body is dropped below
            scope = {**scope, "method": "GET"}

        async def send_with_headers(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                headers = MutableHeaders(scope=message)
                headers.update({**self.headers, "x-request-id": id})
                if headers.get("content-type", "").startswith("image/svg+xml"):
                    headers["content-security-policy"] = SVG_CONTENT_SECURITY
                if not scope["path"].startswith("/static/"):
                    headers.setdefault("cache-control", "no-store")
            elif method == "HEAD":
                message = {**message, "body": b""}
            await send(message)

        try:
            if not is_valid_host(Headers(scope=scope).get("host", "")):
                invalid = "the Host header is not a host name: use the server's address"
                await problem_response(400, "invalid-request", invalid)(scope, receive, send_with_headers)
                return
            await self.app(scope, receive, send_with_headers)
        except ClientDisconnect:
            status = status or DISCONNECTED
        except Exception:
            log.exception("unhandled exception")
            if status == 0:
                await internal_error()(scope, receive, send_with_headers)
        finally:
            took, route = time.perf_counter() - started, getattr(scope.get("route"), "path", "other")
            REQUESTS.labels(method if method in METHODS else "other", route, status).inc()
            SECONDS.labels(route).observe(took)
            log.info(
                "request",
                extra={
                    "method": scope["method"],
                    "route": route,
                    "status": status,
                    "ms": round(1e3 * took, 1),
                },
            )
            request_id.reset(token)
