"""The speed goals, as sentences with the measured ratios."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from bench.peers.clock import Row

SERVER, COMMAND = "polhode over HTTP", "polhode grade"
ONE, WHOLE = "one of fifteen forms", "a whole notebook"
CORE_S, WHOLE_S = 0.035, 0.3


@dataclass(frozen=True)
class Goal:
    """The goal that the time of ``ours`` is at most ``share`` of that of ``theirs``, per submission. The CPU
    ratio is shown too.
    """

    claim: str
    share: float
    ours: Row | None
    theirs: Row | None

    def __str__(self) -> str:
        claim = (
            f"{self.claim}: at most {_share(self.share)} of"
            f" {self.theirs.name if self.theirs else 'a tool that is absent'}"
        )
        if self.ours is None or self.theirs is None:
            return f"not measured  {claim}"
        wall = self.ours.each / self.theirs.each
        cpu = (self.ours.median.cpu / self.ours.count) / (self.theirs.median.cpu / self.theirs.count)
        return f"{_met(wall <= self.share)}  {claim}: {_share(wall)} (CPU {_share(cpu)})"


def limits(rows: Sequence[Row]) -> list[str]:
    """Return the goals in seconds: the CPU time of one submission, and the wall time of a whole notebook."""
    own = {row.what: row.median for row in rows if row.name == SERVER}
    return [
        f"{_met(measured <= limit)}  {claim}: at most {limit:g} s: {measured:.3f} s"
        for claim, limit, measured in (
            ("one over HTTP, CPU time", CORE_S, own[ONE].cpu),
            ("a whole notebook over HTTP", WHOLE_S, own[WHOLE].wall),
        )
    ]


def goals(rows: Sequence[Row], against: Sequence[tuple[str, float]], batch: int) -> list[Goal]:
    """Return the goals: one submission over HTTP ``against`` peers, each with its share; then against the
    fastest peer one submission and a ``batch``, over HTTP and by the command with its start.
    """
    one, peers = (
        {row.name: row for row in rows if row.what == ONE},
        [row for row in rows if not row.name.startswith("polhode")],
    )

    def best(fits: Callable[[Row], bool]) -> Row | None:
        return min(filter(fits, peers), key=lambda row: row.each, default=None)

    def ours(name: str, fits: Callable[[Row], bool]) -> Row | None:
        return next((row for row in rows if row.name == name and fits(row)), None)

    found = [Goal("one over HTTP", share, one.get(SERVER), one.get(name)) for name, share in against]
    for claim, share, name, fits in (
        ("one over HTTP", 1 / 10, SERVER, lambda row: row.what == ONE),
        (f"{batch} at once over HTTP, each", 1 / 20, SERVER, lambda row: row.count == batch),
        (f"one by {COMMAND}", 0.8, COMMAND, lambda row: row.what == ONE),
        (f"{batch} by {COMMAND}, each", 1 / 8, COMMAND, lambda row: row.count == batch),
    ):
        found.append(Goal(claim, share, ours(name, fits), best(fits)))
    return found


def _met(is_met: bool) -> str:
    return "met    " if is_met else "not met"


def _share(ratio: float) -> str:
    return f"1/{1 / ratio:.1f}" if ratio <= 0.4 else f"{ratio:.2f}"
