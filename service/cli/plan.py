"""polhode plan: how long students will wait at a deadline, and how many workers it takes."""

import argparse
import sys
from dataclasses import replace


def add(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    plan = commands.add_parser("plan", help="how long students will wait at a deadline, by simulation; one core per worker")
    plan.add_argument("--students", type=int, required=True, metavar="N")
    plan.add_argument("--minutes", type=float, required=True, metavar="M", help="before the deadline in which they submit")
    plan.add_argument("--workers", type=int, metavar="W", help="how many grade at a time")
    plan.add_argument("--p99", type=float, metavar="SECONDS", help="find how many workers keep 99 of 100 waits below this")
    plan.add_argument("--submissions", type=int, default=3, metavar="K", help="of each student (default 3)")
    plan.add_argument("--rush", action="store_true", help="more and more towards the deadline, linearly; default: evenly")
    plan.add_argument("--seed", type=int, default=0, metavar="S", help="of the draw (default 0)")
    plan.set_defaults(run=_plan)


def _plan(arguments: argparse.Namespace) -> int:
    from service.cli.simulate_queue import Deadline, simulate, table, workers_needed

    given = {name: getattr(arguments, name) for name in ("students", "minutes", "submissions", "rush", "seed")}
    if arguments.workers is None and arguments.p99 is None:
        print("polhode: how many? Give --workers, --p99 or both", file=sys.stderr)
        return 2
    try:
        deadline = Deadline(workers=1 if arguments.workers is None else arguments.workers, **given)
        if arguments.workers is not None:
            print(table(simulate(deadline)))
        if arguments.p99 is not None:
            needed = workers_needed(deadline, arguments.p99)
            print(f"p99 of at most {arguments.p99:g} s takes {needed} worker(s):")
            print(table(simulate(replace(deadline, workers=needed))))
    except ValueError as error:
        print(f"polhode: {error}", file=sys.stderr)
        return 2
    return 0
