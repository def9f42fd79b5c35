"""The speed goals, as sentences with the measured ratios."""

from collections.abc import Sequence
from dataclasses import dataclass

from bench.peers.clock import Row, Timing

SERVER, COMMAND, ONE = "polhode over HTTP", "polhode grade", "one"


@dataclass(frozen=True)
class Goal:
    """The goal that a peer's wall time is at least ``wanted`` times polhode's. The CPU ratio is shown too, as it varies less."""

    claim: str
    wanted: float
    ratio: float | None
    cpu_ratio: float | None

    def __str__(self) -> str:
        if self.ratio is None or self.cpu_ratio is None:
            return f"not measured  {self.claim}"
        met = "met    " if self.ratio >= self.wanted else "not met"
        return f"{met}  {self.claim}: 1/{self.ratio:.1f} (CPU 1/{self.cpu_ratio:.1f})"


def goals(rows: Sequence[Row], against: Sequence[tuple[str, float]], batch: int) -> list[Goal]:
    """Return the goals: one submission over HTTP against one of each peer, and polhode's batches against the
    fastest peer.

    The batches are graded over HTTP and by the command, with and without the command's start.
    """
    one = {r.name: r for r in rows if r.what == ONE}
    found = [
        _goal(f"one over the warm server at most 1/{wanted:g} of {peer}", wanted, one.get(peer), one.get(SERVER))
        for peer, wanted in against
    ]
    peers, ours = best(rows, batch), {r.name: r for r in rows if r.count == batch and r.name.startswith("polhode")}
    than = f"at most 1/8 per submission of the best peer ({peers.name if peers else 'there is none'})"
    command, started = ours.get(COMMAND), one.get(COMMAND)
    return [
        *found,
        _goal(f"{batch} over the warm server {than}", 8, peers, ours.get(SERVER)),
        _goal(f"{batch} by {COMMAND}, from nothing, {than}", 8, peers, command),
        _goal(f"each after the first of {batch} by {COMMAND} {than}", 8, peers, further(command, started)),
    ]


def further(batch: Row | None, one: Row | None) -> Row | None:
    """Return the time of a batch without its first submission, and so without the start of the command."""
    if batch is None or one is None:
        return None
    left = Timing(*(whole - first for whole, first in zip(batch.median, one.median, strict=True)))
    return Row(batch.name, "each after the first", batch.count - 1, [left])


def best(rows: Sequence[Row], batch: int) -> Row | None:
    """Return the peers' batch with the least time per submission."""
    return min((r for r in rows if r.count == batch and not r.name.startswith("polhode")), key=lambda r: r.each, default=None)


def _goal(claim: str, wanted: float, theirs: Row | None, ours: Row | None) -> Goal:
    if theirs is None or ours is None:
        return Goal(claim, wanted, None, None)
    cpu, our_cpu = (row.median.cpu / row.count for row in (theirs, ours))
    return Goal(claim, wanted, theirs.each / ours.each, cpu / our_cpu)
