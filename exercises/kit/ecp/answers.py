"""What comes back from a server: an answer, or a trouble whose text is a sentence for whoever sits at the notebook."""

import json
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple, Protocol
from urllib.parse import urlsplit

from ecp.explained import Explained

MOST_BYTES = 16 * 2**20
DEFAULT_PORTS = {"http": 80, "https": 443}


class Trouble(Explained):
    """``passing``: the same request may succeed later; ``wait_s``: how long the server asks to wait before that."""

    passing: bool
    wait_s: float | None = None


class Unreachable(Trouble):
    """No answer: no network, refused, timed out, not trusted."""

    def __init__(self, sentence: str, *, passing: bool = True) -> None:
        super().__init__(sentence)
        self.passing = passing


class Refused(Trouble):
    """An answer that is an error. ``kind`` is the last part of the problem's type, "" where the server told none."""

    def __init__(self, status: int, kind: str, sentence: str, *, passing: bool = False) -> None:
        super().__init__(sentence)
        self.status, self.kind, self.passing = status, kind, passing


class Answer(NamedTuple):
    """One HTTP answer; the names of its headers are lower-case."""

    status: int
    headers: Mapping[str, str]
    body: bytes

    def json(self) -> Any:
        """The body as JSON; Refused (not-polhode) if it is not."""
        try:
            return json.loads(self.body)
        except ValueError:
            sentence = "The answer is not JSON, so it does not come from a polhode server: check the address."
            raise Refused(self.status, "not-polhode", sentence) from None


class Backend(Protocol):
    """Who carries requests. Header names are lower-case; a redirect is either returned or, within one origin, followed."""

    def request(self, method: str, url: str, body: bytes | None, headers: Mapping[str, str], timeout: float) -> Answer:
        """Any answer; Unreachable if there is none."""
        ...

    def stream(self, url: str, headers: Mapping[str, str], silence: float) -> Iterator[bytes] | None:
        """An event stream as it comes, Unreachable after ``silence`` seconds without a byte; None if there is no stream."""
        ...


def checked(url: str) -> str:
    """The address without its fragment, if it is one of http or https that can be sent; else Unreachable."""
    try:
        parts = urlsplit(url)
        host = (parts.hostname or "").encode("idna")  # ValueError for labels that no name has
        usable = parts.scheme in DEFAULT_PORTS and bool(host) and parts.port != 0
    except ValueError:
        usable = False
    if usable and "@" not in parts.netloc and url.isascii() and url.isprintable() and " " not in url:
        return parts._replace(fragment="").geturl()
    shown = url.rpartition("@")[2].partition("?")[0][:80]
    sentence = f"{shown!r} is not the address of a server: it should look like https://polhode.example.org, without a password."
    raise Unreachable(sentence, passing=False)


def place(url: str) -> str:
    """The server's part of an address, as it is shown to people."""
    parts = urlsplit(url)
    return f"{parts.scheme}://{parts.netloc.rpartition('@')[2]}"


def same_origin(one: str, other: str) -> bool:
    """Whether scheme, host and port agree."""
    a, b = urlsplit(one), urlsplit(other)
    ports = (a.port or DEFAULT_PORTS.get(a.scheme), b.port or DEFAULT_PORTS.get(b.scheme))
    return (a.scheme, a.hostname) == (b.scheme, b.hostname) and ports[0] == ports[1]


def moved(status: int, url: str, target: str) -> Refused:
    """The trouble that a server sends us on to somebody else."""
    sentence = f"The server at {place(url)} sends us on to {place(target)}. Use that address instead if it is your course's."
    return Refused(status, "moved", sentence)


def too_long(url: str) -> Refused:
    """The trouble that an answer has more than MOST_BYTES."""
    return Refused(200, "not-polhode", f"What {place(url)} answers is too long to come from a polhode server: check the address.")
