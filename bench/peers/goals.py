"""What issue 9 asks of the measured times, as sentences with the ratios."""

from collections.abc import Sequence
from dataclasses import dataclass

from bench.peers.clock import Row

SERVER, ONE = "polhode over HTTP", "one"


@dataclass(frozen=True)
class Goal:
    """A peer's time is to be at least ``wanted`` times ours."""

    claim: str
    wanted: float
    ratio: float | None

    def __str__(self) -> str:
        if self.ratio is None:
            return f"not measured  {self.claim}"
        return f"{'met    ' if self.ratio >= self.wanted else 'not met'}  {self.claim}: 1/{self.ratio:.1f}"


def goals(rows: Sequence[Row], against: Sequence[tuple[str, float]], batch: int) -> list[Goal]:
    """For one over HTTP against each peer's one, and for our batch against the best of all peers."""
    one = {r.name: r.each for r in rows if r.what == ONE}
    found = [
        Goal(f"one over the warm server at most 1/{wanted:g} of {peer}", wanted, _ratio(one.get(peer), one.get(SERVER)))
        for peer, wanted in against
    ]
    ours, peers = [r for r in rows if r.name == "polhode grade" and r.count == batch], best(rows, batch)
    claim = f"{batch} by polhode grade at most 1/8 per submission of the best peer ({peers.name if peers else 'there is none'})"
    return [*found, Goal(claim, 8, _ratio(peers and peers.each, ours[0].each if ours else None))]


def best(rows: Sequence[Row], batch: int) -> Row | None:
    """The peers' batch with the least time per submission."""
    return min((r for r in rows if r.count == batch and not r.name.startswith("polhode")), key=lambda r: r.each, default=None)


def _ratio(theirs: float | None, ours: float | None) -> float | None:
    return theirs / ours if theirs and ours else None
