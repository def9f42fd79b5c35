"""One deliberate breakage."""

from typing import NamedTuple


class Breakage(NamedTuple):
    """``old`` occurs once in ``file`` and becomes ``new``; one of the ``tests`` (files or functions of files)
    must then fail.
    """

    name: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]
