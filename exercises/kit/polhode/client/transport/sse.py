"""Server-sent events, parsed from the bytes of a stream."""

import json
from collections.abc import Generator, Iterable, Iterator
from typing import Any, NamedTuple

LONGEST_LINE = 2**20


class Event(NamedTuple):
    """One event. ``id`` is "" if it has none, as for a status that was requested instead of streamed."""

    name: str
    id: str
    data: dict[str, Any]


def parse_events(chunks: Iterable[bytes]) -> Generator[Event, None, None]:
    """Yield the events whose data is a JSON object.

    An event that is cut off is dropped. A line longer than LONGEST_LINE bytes ends the stream.
    """
    fields: dict[str, str] = {}
    for line in _lines(chunks):
        if line:
            _take(line, fields)
            continue
        if (data := _object(fields.get("data", ""))) is not None:
            yield Event(fields.get("event", "message"), fields.get("id", ""), data)
        fields = {}


def _lines(chunks: Iterable[bytes]) -> Iterator[str]:
    held = b""
    for chunk in chunks:
        *lines, held = (held + chunk).split(b"\n")
        for line in lines:
            yield line.decode("utf-8", "replace").removesuffix("\r")
        if len(held) > LONGEST_LINE:
            return


def _take(line: str, fields: dict[str, str]) -> None:
    name, _, value = line.partition(":")
    value = value.removeprefix(" ")
    if name == "data" and "data" in fields:
        fields["data"] += "\n" + value
    elif name != "id" or (value.isascii() and value.isprintable()):  # an id goes back in a header
        fields[name] = value


def _object(data: str) -> dict[str, Any] | None:
    try:
        value = json.loads(data)
    except ValueError:
        return None
    return value if isinstance(value, dict) else None
