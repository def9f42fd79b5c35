"""Where in a submission's source a traceback points."""

import re
from dataclasses import dataclass

from ecp.outcome import SceneEnding

BREAK = re.compile(r"\r\n|\r|\n")  # where Python begins a line; other breaks, such as a form feed, begin none
_FRAME = re.compile(r'^\s*File "([^"]+)", line (\d+)')


@dataclass(frozen=True)
class Place:
    """A line, from 1, of a cell by the name that a traceback has for it."""

    cell: str
    line: int


def places(ending: SceneEnding) -> list[Place]:
    """The submission's own lines in a traceback, outermost first; what an exception says of itself is not read."""
    found = []
    for line in (ending.traceback or "").split("\n"):
        if line and not line[0].isspace():
            break
        if frame := _FRAME.match(line):
            found.append(Place(frame[1], int(frame[2][:9])))
    return found
