"""Which walls: the ones that were asked for, or a clear refusal. There is no silent fallback."""

from service.sandbox.bubblewrap import bubblewrap_walls, find_bubblewrap
from service.sandbox.walls import Walls, process_walls


class WallsMissing(Exception):
    """No wall that was asked for can be put up here; the message says what to do."""


def choose(name: str) -> Walls:
    """The walls of that name, "bubblewrap" or "process"; WallsMissing if they cannot be had."""
    if name == "process":
        return process_walls()
    if name != "bubblewrap":
        raise WallsMissing(f'POLHODE_WALLS is "bubblewrap" or "process", not {name!r}')
    program = find_bubblewrap()
    if program is None:
        raise WallsMissing(
            "bubblewrap is not installed, and without it submissions would run beside the server's own files. Install it "
            "(apt install bubblewrap), or set POLHODE_WALLS=process to grade code you trust: it then runs as an ordinary "
            "process that can read whatever the server can."
        )
    return bubblewrap_walls(program)
