"""Markdown tables for docs/benchmarks.md."""

from collections.abc import Mapping, Sequence

from bench.peers.clock import Row
from bench.peers.peer import Marks


def table(head: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    """Return a Markdown table with aligned columns."""
    lines = [head, *lines]
    widths = [max(len(line[k]) for line in lines) for k in range(len(head))]
    rendered = [
        "| " + " | ".join(c.ljust(w) for c, w in zip(line, widths, strict=True)) + " |" for line in lines
    ]
    return "\n".join([rendered[0], "|" + "|".join("-" * (w + 2) for w in widths) + "|", *rendered[1:]])


def times(rows: Sequence[Row]) -> str:
    """Return the table of times: medians, range, and medians per submission, in seconds."""
    head = ("tool", "what", "wall s", "least – greatest", "CPU s", "wall s each", "CPU s each")
    return table(head, [_time(row) for row in rows])


def verdicts(kinds: Sequence[str], given: Mapping[str, Mapping[str, Marks | str]]) -> str:
    """Return a table with a line for each kind of submission and a column for each tool."""
    lines = [[kind, *(_mark(of.get(kind, "–")) for of in given.values())] for kind in kinds]
    return table(["submission", *given], lines)


def _time(row: Row) -> list[str]:
    wall, cpu = row.median
    walls = [t.wall for t in row.taken]
    spread = f"{min(walls):.3f} – {max(walls):.3f}"
    return [
        row.name,
        row.what,
        f"{wall:.3f}",
        spread,
        f"{cpu:.3f}",
        f"{wall / row.count:.3f}",
        f"{cpu / row.count:.3f}",
    ]


def _mark(mark: Marks | str) -> str:
    return mark if isinstance(mark, str) else f"{'**' if mark.full else ''}{mark}{'**' if mark.full else ''}"
