"""What issue 9 asks of the measured times, as sentences with the ratios."""

from collections.abc import Sequence
from dataclasses import dataclass

from bench.peers.clock import Row, Took

SERVER, COMMAND, ONE = "polhode over HTTP", "polhode grade", "one"


@dataclass(frozen=True)
class Goal:
    """A peer's wall time is to be at least ``wanted`` times ours; CPU time is told because it is the steadier of the two."""

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
    """For one over HTTP against each peer's one, and for our batches against the best of all peers: over HTTP, and by the command
    as a whole and without its start.
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
    """What the batch takes beyond a single one, for the others in it: its start is left out."""
    if batch is None or one is None:
        return None
    left = Took(*(whole - first for whole, first in zip(batch.median, one.median, strict=True)))
    return Row(batch.name, "each after the first", batch.count - 1, [left])


def best(rows: Sequence[Row], batch: int) -> Row | None:
    """The peers' batch with the least time per submission."""
    return min((r for r in rows if r.count == batch and not r.name.startswith("polhode")), key=lambda r: r.each, default=None)


def _goal(claim: str, wanted: float, theirs: Row | None, ours: Row | None) -> Goal:
    if theirs is None or ours is None:
        return Goal(claim, wanted, None, None)
    cpu, our_cpu = (row.median.cpu / row.count for row in (theirs, ours))
    return Goal(claim, wanted, theirs.each / ours.each, cpu / our_cpu)
