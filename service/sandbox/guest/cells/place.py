"""Where a statement of a submission stands."""

from typing import NamedTuple


class Place(NamedTuple):
    """Where a statement begins: the name of its cell, its line from 1, and its column from 0."""

    cell: str
    line: int
    column: int
