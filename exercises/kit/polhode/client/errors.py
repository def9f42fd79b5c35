"""Exceptions whose message is shown to the person at the notebook."""

import json
from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any, NamedTuple
from urllib.parse import urlsplit

MOST_BYTES = 16 * 2**20
DEFAULT_PORTS = {"http": 80, "https": 443}
PASSING = (429, 502, 503, 504)
LONGEST_DETAIL, SHORTEST_TOKEN = 500, 6
SENTENCES = {
    "nobody": "You are not logged in at {place}{detail}: run polhode.login() and try again.",
    "deadline-over": "The deadline has passed{detail}: nothing was submitted.",
    "not-available": "The assignment is not available yet{detail}.",
    "none-left": "You have no submissions left{detail}: nothing was submitted.",
    "too-many-open": "Nothing was submitted{detail}.",
    "too-large": (
        "The submission is too large for the server at {place}{detail}: submit less, such as"
        " polhode.submit(euler_eqs)."
    ),
    "busy": "The server at {place} is busy{detail}: try again in a few minutes.",
    "fault": (
        "The server at {place} failed; this is not your mistake{number}: try again, then ask your course"
        " staff."
    ),
    "not-polhode": (
        "There is no polhode server at {place}, something else answered ({status}{page}): check the address."
    ),
    "": "The server at {place} refused the request ({status}).",
}
WITHOUT_PROBLEM = {401: "nobody", 404: "not-polhode", 413: "too-large", 500: "fault"} | dict.fromkeys(
    PASSING, "busy"
)


class NotebookError(Exception):
    """An error whose message says what happened and what to do. IPython shows the message without a
    traceback.
    """

    def _render_traceback_(self) -> list[str]:
        return [str(self)]


class RequestError(NotebookError):
    """A request failed. ``passing``: a later try may succeed. ``wait_s``: seconds the server asks to wait
    before it.
    """

    passing: bool
    wait_s: float | None = None


class Unreachable(RequestError):
    """There is no answer: no network, connection refused, timeout, or an untrusted certificate."""

    def __init__(self, sentence: str, *, passing: bool = True) -> None:
        super().__init__(sentence)
        self.passing = passing


class HTTPError(RequestError):
    """The answer is an error. ``kind`` is the last part of the problem's type, "" if the server gave none."""

    def __init__(self, status: int, kind: str, sentence: str, *, passing: bool = False) -> None:
        super().__init__(sentence)
        self.status, self.kind, self.passing = status, kind, passing


class Answer(NamedTuple):
    """One HTTP answer. Header names are lower case."""

    status: int
    headers: Mapping[str, str]
    body: bytes

    def json(self) -> Any:
        """Return the body as JSON. Raises HTTPError (not-polhode) if it is not JSON."""
        try:
            return json.loads(self.body)
        except ValueError:
            sentence = "The answer is not JSON, so it does not come from a polhode server: check the address."
            raise HTTPError(self.status, "not-polhode", sentence) from None


def checked(url: str) -> str:
    """Return an http or https address without its fragment. Raises Unreachable if it is no such address."""
    try:
        parts = urlsplit(url)
        host = (parts.hostname or "").encode("idna")  # ValueError for labels that no name has
        usable = parts.scheme in DEFAULT_PORTS and bool(host) and parts.port != 0
    except ValueError:
        usable = False
    if usable and "@" not in parts.netloc and url.isascii() and url.isprintable() and " " not in url:
        return parts._replace(fragment="").geturl()
    shown = url.rpartition("@")[2].partition("?")[0][:80]
    sentence = (
        f"{shown!r} is not a server address: use one like https://polhode.example.org, without a password."
    )
    raise Unreachable(sentence, passing=False)


def place(url: str) -> str:
    """Return scheme, host and port of an address, for messages."""
    parts = urlsplit(url)
    return f"{parts.scheme}://{parts.netloc.rpartition('@')[2]}"


def same_origin(one: str, other: str) -> bool:
    """Return whether scheme, host and port agree."""
    a, b = urlsplit(one), urlsplit(other)
    ports = (a.port or DEFAULT_PORTS.get(a.scheme), b.port or DEFAULT_PORTS.get(b.scheme))
    return (a.scheme, a.hostname) == (b.scheme, b.hostname) and ports[0] == ports[1]


def moved(status: int, url: str, target: str) -> HTTPError:
    """Return the error for a redirect to another server."""
    sentence = (
        f"The server at {place(url)} redirects to {place(target)}: use that address if it is your course's."
    )
    return HTTPError(status, "moved", sentence)


def too_long(url: str) -> HTTPError:
    """Return the error for an answer longer than MOST_BYTES."""
    return HTTPError(
        200, "not-polhode", f"The answer of {place(url)} is too long for a polhode server: check the address."
    )


def refusal(answer: Answer, url: str, headers: Mapping[str, str]) -> HTTPError:
    """Return the exception for an error answer to a request with ``headers``. Its message never contains
    their token.
    """
    problem = _problem(answer)
    kind = (
        str(problem.get("type", "")).rpartition(":")[2] if problem else WITHOUT_PROBLEM.get(answer.status, "")
    )
    detail = _clean(str(problem.get("detail", "")), headers)
    passing = answer.status in PASSING
    refused = HTTPError(answer.status, kind, _sentence(answer, url, kind, detail), passing=passing)
    refused.wait_s = (
        retry_after(answer.headers.get("retry-after", ""), datetime.now(UTC)) if passing else None
    )
    return refused


def not_polhode(answer: Answer, url: str) -> HTTPError:
    """Return the exception for an answer, of any status, that polhode does not give."""
    return HTTPError(answer.status, "not-polhode", _sentence(answer, url, "not-polhode", ""))


def retry_after(value: str, now: datetime) -> float | None:
    """Return the seconds that ``Retry-After`` asks for, as a number or a date; None if it is neither."""
    if value.strip().isdecimal():
        return float(value)
    from email.utils import parsedate_to_datetime  # only here, as a guest imports this module too

    try:
        return max(0.0, (parsedate_to_datetime(value) - now).total_seconds())
    except (ValueError, TypeError):  # TypeError: a date without a zone
        return None


def is_page(answer: Answer) -> bool:
    """Return whether the answer is a web page."""
    return "html" in answer.headers.get("content-type", "")


def _sentence(answer: Answer, url: str, kind: str, detail: str) -> str:
    key = "nobody" if answer.status == 401 else kind
    if detail and key not in SENTENCES:
        return detail[0].upper() + detail[1:].rstrip(".") + "."
    request = "".join(
        c for c in answer.headers.get("x-request-id", "")[:80] if c.isascii() and (c.isalnum() or c in "-_")
    )
    return SENTENCES.get(key, SENTENCES[""]).format(
        place=place(url),
        status=answer.status,
        detail=f" ({detail.rstrip('.')})" if detail else "",
        number=f" (request {request})" if request else "",
        page=", a web page, perhaps a login page" if is_page(answer) else "",
    )


def _problem(answer: Answer) -> dict[str, Any]:
    if not answer.headers.get("content-type", "").startswith("application/problem+json"):
        return {}
    try:
        problem = json.loads(answer.body)
    except ValueError:
        return {}
    return problem if isinstance(problem, dict) else {}


def _clean(detail: str, headers: Mapping[str, str]) -> str:
    token = headers.get("authorization", "").rpartition(" ")[2]
    plain = "".join(c if c.isprintable() else " " for c in detail)
    return (plain.replace(token, "…") if len(token) >= SHORTEST_TOKEN else plain)[:LONGEST_DETAIL].strip()
