"""The command ``polhode plan``: how long students wait at a deadline, and how many workers are needed."""

import argparse
import sys
from dataclasses import replace


def add(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Add the command."""
    plan = commands.add_parser("plan", help="simulate how long students wait at a deadline, with one core per worker")
    plan.add_argument("--students", type=int, required=True, metavar="N", help="number of students")
    plan.add_argument("--minutes", type=float, required=True, metavar="M", help="minutes before the deadline in which they submit")
    plan.add_argument("--workers", type=int, metavar="W", help="number of workers, each grading one submission at a time")
    plan.add_argument(
        "--p99", type=float, metavar="SECONDS", help="find the number of workers that keeps 99 of 100 waits below this"
    )
    plan.add_argument("--notebook", action="store_true", help="students submit whole notebooks; default: one exercise")
    plan.add_argument("--submissions", type=int, default=3, metavar="K", help="submissions per student (default 3)")
    plan.add_argument(
        "--rush", action="store_true", help="submissions per minute grow linearly towards the deadline; default: constant"
    )
    plan.add_argument("--seed", type=int, default=0, metavar="S", help="seed of the simulation (default 0)")
    plan.set_defaults(run=_plan)


def _plan(arguments: argparse.Namespace) -> int:
    from service.cli.simulate_queue import Deadline, measured, simulate, table, workers_needed

    given = {name: getattr(arguments, name) for name in ("students", "minutes", "submissions", "rush", "seed")}
    if arguments.workers is None and arguments.p99 is None:
        print("polhode: nothing to simulate: give --workers, --p99 or both", file=sys.stderr)
        return 2
    try:
        seconds = measured("notebook" if arguments.notebook else "exercise")
        deadline = Deadline(workers=1 if arguments.workers is None else arguments.workers, seconds=seconds, **given)
        if arguments.workers is not None:
            print(table(simulate(deadline)))
        if arguments.p99 is not None:
            needed = workers_needed(deadline, arguments.p99)
            print(f"{needed} worker(s) keep the p99 wait at or below {arguments.p99:g} s:")
            print(table(simulate(replace(deadline, workers=needed))))
    except ValueError as error:
        print(f"polhode: {error}", file=sys.stderr)
        return 2
    return 0
