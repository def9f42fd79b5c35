"""How long students wait at a deadline: the queue of ``service.store.queue``, simulated event by event.

Every student sends each submission at a moment of its own, independent of all others and of any result: uniform over the time
before the deadline, or with ``rush`` of a density that grows linearly from zero to the deadline. Every worker grades one
submission at a time and has a core of its own; how long it takes is drawn, with replacement, from measured times.
"""

import json
from bisect import bisect_left
from dataclasses import dataclass, field
from heapq import heappop, heappush
from itertools import count
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from service.store.queue import STEP

MEASURED = Path(__file__).parents[1] / "grading" / "measured" / "service-times.json"
MOST, YEAR_MIN = 5_000_000, 366 * 24 * 60
QUANTILES = {"p50": 0.5, "p90": 0.9, "p99": 0.99, "max": 1.0}


@dataclass(frozen=True)
class Deadline:
    """What to simulate; ``seconds`` are the service times drawn from. Raises ValueError, naming all that is out of range."""

    students: int
    minutes: float
    workers: int
    submissions: int = 3
    rush: bool = False
    seed: int = 0
    seconds: tuple[float, ...] = field(default_factory=lambda: tuple(json.loads(MEASURED.read_text())["seconds"]), repr=False)

    def __post_init__(self) -> None:
        if wrong := [name for name in ("students", "minutes", "workers", "submissions") if not 0 < getattr(self, name) < np.inf]:
            raise ValueError(f"must be more than 0: {', '.join(wrong)}")
        if self.students * self.submissions > MOST or self.minutes > YEAR_MIN:
            raise ValueError(f"at most {MOST} submissions and {YEAR_MIN} minutes")


@dataclass(frozen=True)
class Arrivals:
    """Submissions as they come, each (n,): accepted when (s), whose, which of that person's (from 1), for how long a worker (s)."""

    accepted: NDArray[np.float64]
    person: NDArray[np.int64]
    turn: NDArray[np.int64]
    service: NDArray[np.float64]


@dataclass(frozen=True)
class Waiting:
    """Quantiles of the seconds from accepted to started, of all and of each student's first and last; the most that wait at a time;
    the seconds from the deadline until nobody waits, 0 if that was before; the share of the workers' time spent on submissions,
    until the deadline or the last result if that is later."""

    waits: dict[str, dict[str, float]]
    longest_queue: int
    emptied_s: float
    utilisation: float


def simulate(deadline: Deadline) -> Waiting:
    """Draw the arrivals and play them through; the same seed gives the same answer."""
    arrivals = draw(deadline)
    return summary(arrivals, begin(arrivals, deadline.workers), deadline.workers, 60 * deadline.minutes)


def workers_needed(deadline: Deadline, p99_s: float) -> int:
    """How many workers keep the 99th percentile of waits at or below ``p99_s`` seconds, where one fewer does not; by doubling, then
    bisection. ``deadline.workers`` is not used. Raises ValueError for a negative ``p99_s``."""
    if not p99_s >= 0:
        raise ValueError("no wait is shorter than 0 seconds")
    arrivals = draw(deadline)

    def enough(workers: int) -> bool:
        return bool(np.quantile(begin(arrivals, workers) - arrivals.accepted, 0.99) <= p99_s)

    high = next(2**k for k in count() if enough(2**k))
    return bisect_left(range(high), True, lo=min(high, high // 2 + 1), key=enough)


def draw(deadline: Deadline) -> Arrivals:
    """Arrivals from the deadline's seed; they do not depend on the number of workers."""
    random = np.random.default_rng(deadline.seed)
    share = random.random((deadline.students, deadline.submissions))
    moments = 60 * deadline.minutes * np.sort(np.sqrt(share) if deadline.rush else share)  # √u has density 2u
    order = np.argsort(moments, axis=None, kind="stable")
    person, turn = np.divmod(order, deadline.submissions)
    return Arrivals(moments.ravel()[order], person, turn + 1, random.choice(deadline.seconds, moments.size))


def begin(arrivals: Arrivals, workers: int) -> NDArray[np.float64]:
    """When each submission is begun (n,), in seconds: the lowest rank first, within a rank in the order of coming to it.

    The rank counts its person's earlier submissions without result: taken when it is accepted, and anew at each result of that
    person for the oldest that waits with a rank above 0. A result at the very moment of an arrival comes before it.
    """
    person, service, begun = arrivals.person.tolist(), arrivals.service.tolist(), np.empty(len(arrivals.person))
    events = [(moment, True, one) for one, moment in enumerate(arrivals.accepted.tolist())]  # False: its result
    unfinished: dict[int, list[int]] = {who: [] for who in person}  # the oldest first
    rank, place, places = [0] * len(events), [0] * len(events), count()  # what does not wait keeps rank 0
    queue: list[tuple[int, int, int]] = []  # rank, place, submission; void where that has another place by now
    while events:
        now, arrives, one = heappop(events)
        mine = unfinished[person[one]]
        if arrives:
            mine.append(one)
        else:
            mine.remove(one)
            workers += 1
        moved = one if arrives else next((other for other in mine if rank[other]), None)
        if moved is not None:
            rank[moved], place[moved] = min(STEP - 1, bisect_left(mine, moved)), next(places)
            heappush(queue, (rank[moved], place[moved], moved))
        while workers and queue:
            _, at, one = heappop(queue)
            if at == place[one]:
                rank[one], begun[one], workers = 0, now, workers - 1
                heappush(events, (now + service[one], False, one))
    return begun


def summary(arrivals: Arrivals, begun: NDArray[np.float64], workers: int, deadline_s: float) -> Waiting:
    """How these arrivals waited, simulated or real: ``begun`` (n,) tells when each was begun, the deadline is at ``deadline_s``."""
    waits, last = begun - arrivals.accepted, int(arrivals.turn.max())
    chosen = {"all": waits, "students' first": waits[arrivals.turn == 1], f"students' no. {last}": waits[arrivals.turn == last]}
    quantiles = {name: {q: float(np.quantile(those, share)) for q, share in QUANTILES.items()} for name, those in chosen.items()}
    moments = np.concatenate([begun, arrivals.accepted])  # at the same moment one leaves the queue before another joins it
    queue = np.cumsum(np.repeat([-1, 1], len(begun))[np.argsort(moments, kind="stable")])
    busy = float(arrivals.service.sum()) / workers / max(deadline_s, float((begun + arrivals.service).max()))
    return Waiting(quantiles, int(queue.max()), max(0.0, float(begun.max()) - deadline_s), busy)


def table(waiting: Waiting) -> str:
    """For a terminal."""
    rows = {"seconds waited": [*QUANTILES]} | {n: [f"{s:.1f}" for s in row.values()] for n, row in waiting.waits.items()}
    lines = [f"{name:20}" + "".join(f"{cell:>9}" for cell in cells) for name, cells in rows.items()]
    lines.append(f"longest queue {waiting.longest_queue}, workers {waiting.utilisation:.0%} busy")
    return "\n".join([*lines, f"nobody waits any more {waiting.emptied_s:.0f} s after the deadline"])
