"""``python -m bench.plan``: event-by-event simulation of how long students wait at a deadline, with the queue
order of ``service.store.queue.jobs``.

Each student sends each submission at a random time, independent of the others and of any result. The times
before the deadline are uniform; with ``rush`` their density grows linearly from zero to the deadline. Each
worker has its own core and grades one submission at a time. Grading times are drawn with replacement from
measured ones.
"""

import argparse
import io
import json
import sys
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from heapq import heappop, heappush
from itertools import count
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from service.store.queue.jobs import SLOW_STEP

MEASURED = Path(__file__).with_name("measured") / "service-times.json"
MOST, YEAR_MIN = 5_000_000, 366 * 24 * 60
CLASSES = (300, 1000, 3000, 10_000, 30_000, 100_000)
KINDS = {"exercise": "one exercise", "notebook": "a whole notebook"}
COLORS = ("#0072b2", "#d55e00")
QUANTILES = {"p50": 0.5, "p90": 0.9, "p99": 0.99, "max": 1.0}


def main(words: Sequence[str] | None = None) -> int:
    """Print the waits or draw the costs. Return the exit code, 2 for values that are out of range."""
    parser = argparse.ArgumentParser(prog="python -m bench.plan", description=__doc__)
    asked = parser.add_mutually_exclusive_group(required=True)
    asked.add_argument("--students", type=int, metavar="N", help="number of students")
    asked.add_argument(
        "--chart",
        type=Path,
        metavar="FILE.svg",
        help="draw the cost per submission for 300 to 100 000 students; needs --p99",
    )
    parser.add_argument(
        "--minutes",
        type=float,
        required=True,
        metavar="M",
        help="minutes before the deadline in which they submit",
    )
    parser.add_argument(
        "--workers", type=int, metavar="W", help="number of workers, each grading one submission at a time"
    )
    parser.add_argument(
        "--p99",
        type=float,
        metavar="SECONDS",
        help="find the number of workers that keeps 99 of 100 waits below this",
    )
    parser.add_argument(
        "--notebook", action="store_true", help="students submit whole notebooks; default: one exercise"
    )
    parser.add_argument(
        "--submissions", type=int, default=3, metavar="K", help="submissions per student (default 3)"
    )
    parser.add_argument(
        "--rush",
        action="store_true",
        help="submissions per minute grow linearly towards the deadline; default: constant",
    )
    parser.add_argument("--seed", type=int, default=0, metavar="S", help="seed of the simulation (default 0)")
    try:
        _plan(parser.parse_args(words))
    except ValueError as error:
        print(f"bench.plan: {error}", file=sys.stderr)
        return 2
    return 0


def _plan(arguments: argparse.Namespace) -> None:
    given = {
        name: getattr(arguments, name) for name in ("students", "minutes", "submissions", "rush", "seed")
    }
    if arguments.chart:
        if arguments.p99 is None or arguments.workers is not None or arguments.notebook:
            raise ValueError(
                "--chart finds the workers for exercises and for notebooks: give --p99, not --workers or"
                " --notebook"
            )
        deadlines = [
            Deadline(**given | {"students": CLASSES[0], "workers": 1, "seconds": measured(kind)})
            for kind in KINDS
        ]
        arguments.chart.write_bytes(
            draw_costs([costs(one, arguments.p99) for one in deadlines], deadlines, arguments.p99)
        )
        return
    if arguments.workers is None and arguments.p99 is None:
        raise ValueError("nothing to simulate: give --workers, --p99 or both")
    seconds = measured("notebook" if arguments.notebook else "exercise")
    deadline = Deadline(
        workers=1 if arguments.workers is None else arguments.workers, seconds=seconds, **given
    )
    if arguments.workers is not None:
        print(table(simulate(deadline)))
    if arguments.p99 is not None:
        needed = workers_needed(deadline, arguments.p99)
        print(f"{needed} worker(s) keep the p99 wait at or below {arguments.p99:g} s:")
        print(table(simulate(replace(deadline, workers=needed))))


@dataclass(frozen=True)
class Deadline:
    """The parameters of a simulation; ``seconds`` are the grading times to draw from, by default those of one
    exercise.

    Raises ValueError listing all values that are out of range.
    """

    students: int
    minutes: float
    workers: int
    submissions: int = 3
    rush: bool = False
    seed: int = 0
    seconds: tuple[float, ...] = field(default_factory=lambda: measured("exercise"), repr=False)

    def __post_init__(self) -> None:
        if wrong := [
            name
            for name in ("students", "minutes", "workers", "submissions")
            if not 0 < getattr(self, name) < np.inf
        ]:
            *others, last = [f"--{name}" for name in wrong]
            raise ValueError(f"{', '.join(others)}{' and ' if others else ''}{last} must be more than 0")
        if self.students * self.submissions > MOST or self.minutes > YEAR_MIN:
            raise ValueError(
                f"the simulation is too large: at most {MOST} submissions and {YEAR_MIN} minutes"
            )


def measured(kind: str) -> tuple[float, ...]:
    """Return the measured grading times (s) of ``kind``: "exercise" (one exercise) or "notebook" (a whole
    notebook).
    """
    return tuple(json.loads(MEASURED.read_text())[kind]["seconds"])


@dataclass(frozen=True)
class Arrivals:
    """Submissions in order of arrival, each array (n,): time of acceptance (s), person, number of the
    person's submission (from 1), and grading time (s).
    """

    accepted: NDArray[np.float64]
    person: NDArray[np.int64]
    turn: NDArray[np.int64]
    service: NDArray[np.float64]


@dataclass(frozen=True)
class WaitStatistics:
    """Statistics of the waits.

    ``waits`` holds quantiles of the seconds from acceptance to start, for all submissions, each student's
    first and each student's last. ``longest_queue`` is the largest number of waiting submissions.
    ``emptied_s`` is the time (s) from the deadline until the queue is empty, 0 if it was empty before.
    ``utilisation`` is the share of the workers' time spent on submissions, until the deadline or the last
    result, whichever is later.
    """

    waits: dict[str, dict[str, float]]
    longest_queue: int
    emptied_s: float
    utilisation: float


def simulate(deadline: Deadline) -> WaitStatistics:
    """Simulate the deadline. The same seed gives the same result."""
    arrivals = draw(deadline)
    return summary(arrivals, start_times(arrivals, deadline.workers), deadline.workers, 60 * deadline.minutes)


def workers_needed(deadline: Deadline, p99_s: float) -> int:
    """Return the smallest number of workers that keeps the 99th percentile of the waits at or below ``p99_s``
    seconds.

    The search doubles the number, then bisects; ``deadline.workers`` is ignored. Raises ValueError for a
    negative ``p99_s``.
    """
    if not p99_s >= 0:
        raise ValueError(f"--p99 must not be negative, got {p99_s:g}")
    arrivals = draw(deadline)

    def enough(workers: int) -> bool:
        return bool(np.quantile(start_times(arrivals, workers) - arrivals.accepted, 0.99) <= p99_s)

    high = next(2**k for k in count() if enough(2**k))
    return bisect_left(range(high), True, lo=min(high, high // 2 + 1), key=enough)


def draw(deadline: Deadline) -> Arrivals:
    """Draw the arrivals from the deadline's seed; they do not depend on the number of workers."""
    random = np.random.default_rng(deadline.seed)
    share = random.random((deadline.students, deadline.submissions))
    moments = 60 * deadline.minutes * np.sort(np.sqrt(share) if deadline.rush else share)  # √u has density 2u
    order = np.argsort(moments, axis=None, kind="stable")
    person, turn = np.divmod(order, deadline.submissions)
    return Arrivals(moments.ravel()[order], person, turn + 1, random.choice(deadline.seconds, moments.size))


def start_times(arrivals: Arrivals, workers: int) -> NDArray[np.float64]:
    """Return the start time of each submission (n,) in seconds: lowest rank first, within a rank in order of
    entering it.

    A submission's rank is the number of its student's earlier unfinished submissions. It is set on
    acceptance, and again after each result of that student for the oldest waiting submission with a rank
    above 0. A result precedes an arrival at the same time.
    """
    person, service, begun = (
        arrivals.person.tolist(),
        arrivals.service.tolist(),
        np.empty(len(arrivals.person)),
    )
    # (time, is an arrival, submission)
    events = [(moment, True, one) for one, moment in enumerate(arrivals.accepted.tolist())]
    unfinished: dict[int, list[int]] = {one: [] for one in person}  # oldest first
    # a submission that does not wait has rank 0
    rank, place, places = (
        [0] * len(events),
        [0] * len(events),
        count(),
    )
    queue: list[
        tuple[int, int, int]
    ] = []  # (rank, place, submission); void if the submission's place has changed
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
            rank[moved], place[moved] = min(SLOW_STEP - 2, bisect_left(mine, moved)), next(places)
            heappush(queue, (rank[moved], place[moved], moved))
        while workers and queue:
            _, at, one = heappop(queue)
            if at == place[one]:
                rank[one], begun[one], workers = 0, now, workers - 1
                heappush(events, (now + service[one], False, one))
    return begun


def summary(
    arrivals: Arrivals, begun: NDArray[np.float64], workers: int, deadline_s: float
) -> WaitStatistics:
    """Return the statistics of simulated or measured waits. ``begun`` (n,) are the start times,
    ``deadline_s`` is the deadline, in seconds.
    """
    waits, last = begun - arrivals.accepted, int(arrivals.turn.max())
    chosen = {
        "all": waits,
        "students' first": waits[arrivals.turn == 1],
        f"students' no. {last}": waits[arrivals.turn == last],
    }
    quantiles = {
        name: {q: float(np.quantile(those, share)) for q, share in QUANTILES.items()}
        for name, those in chosen.items()
    }
    moments = np.concatenate([begun, arrivals.accepted])  # at equal times a start precedes an arrival
    queue = np.cumsum(np.repeat([-1, 1], len(begun))[np.argsort(moments, kind="stable")])
    busy = float(arrivals.service.sum()) / workers / max(deadline_s, float((begun + arrivals.service).max()))
    return WaitStatistics(quantiles, int(queue.max()), max(0.0, float(begun.max()) - deadline_s), busy)


def table(waiting: WaitStatistics) -> str:
    """Return the statistics as a table for a terminal."""
    rows = {"seconds waited": [*QUANTILES]} | {
        n: [f"{s:.1f}" for s in row.values()] for n, row in waiting.waits.items()
    }
    lines = [f"{name:20}" + "".join(f"{cell:>9}" for cell in cells) for name, cells in rows.items()]
    lines.append(f"longest queue {waiting.longest_queue}, workers {waiting.utilisation:.0%} busy")
    return "\n".join([*lines, f"queue empty {waiting.emptied_s:.0f} s after the deadline"])


def costs(deadline: Deadline, p99_s: float) -> list[tuple[int, int, float]]:
    """Return students, workers, and core-seconds per submission until the queue is empty, for each size in
    CLASSES.

    The workers are the fewest that keep the 99th percentile of the waits at or below ``p99_s`` seconds.
    Raises ValueError.
    """
    found = []
    for students in CLASSES:
        asked = replace(deadline, students=students)
        asked = replace(asked, workers=workers_needed(asked, p99_s))
        reserved_s = asked.workers * (60 * asked.minutes + simulate(asked).emptied_s)
        found.append((students, asked.workers, reserved_s / (students * asked.submissions)))
    return found


def draw_costs(
    found: Sequence[list[tuple[int, int, float]]], deadlines: Sequence[Deadline], p99_s: float
) -> bytes:
    """Draw the ``costs`` of the ``deadlines``, one for each of KINDS, against the class size, log-log, as
    SVG.
    """
    import matplotlib as mpl
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.ticker import LogLocator

    canvas = Figure(figsize=(9, 5))
    FigureCanvasAgg(canvas)
    axes = canvas.add_axes((0.08, 0.12, 0.72, 0.76))
    first = deadlines[0]
    for rows, deadline, what, color, up in zip(
        found, deadlines, KINDS.values(), COLORS, (-14, 7), strict=True
    ):
        mean = float(np.mean(deadline.seconds))
        axes.loglog([row[0] for row in rows], [row[2] for row in rows], marker="o", color=color)
        axes.axhline(mean, color=color, lw=0.8, ls=":")
        for students, workers, cost in rows:
            axes.annotate(
                f"{workers}",
                (students, cost),
                (0, up),
                textcoords="offset points",
                ha="center",
                fontsize=9,
                color=color,
            )
        label = f"{what}:\n{rows[-1][2]:.2g} core-s, of which\n{mean:.2g} s grading (dotted)"
        axes.text(
            1.02,
            rows[-1][2],
            label,
            transform=axes.get_yaxis_transform(),
            color=color,
            va="center",
            fontsize=9,
        )
    minutes = f"{first.minutes:g} min{', ever more towards the deadline' if first.rush else ''}"
    axes.set(xlabel="students", ylabel="reserved core-seconds per submission")
    axes.set_title(
        f"{first.submissions} submissions each in {minutes}; 99 % wait at most {p99_s:g} s\n(numbers:"
        " workers, one core each)"
    )
    axes.set_xticks(CLASSES, [f"{students:,}".replace(",", "\u202f") for students in CLASSES])
    axes.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axes.yaxis.set_major_formatter("{x:g}")
    axes.minorticks_off()
    axes.margins(y=0.1)
    axes.grid(alpha=0.3)
    stream = io.BytesIO()
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "polhode"}):
        title = "Cost per submission against class size"
        canvas.savefig(stream, format="svg", metadata={"Title": title, "Date": None})
    return stream.getvalue()


if __name__ == "__main__":
    sys.exit(main())
