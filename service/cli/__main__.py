"""The command-line entry point ``polhode``: one module for each group of commands.

A command's modules are imported when it runs, so that a failing import exits with code 2. Codes 0 and 1 are
answers: of ``grade``, all checks ✓ or not; of ``mutants``, whether the checks accept exactly the right
functions. Code 141 means that standard output was closed early.
"""

import argparse
import io
import os
import sys
import traceback
from pathlib import Path
from typing import TextIO

CANNOT, PIPE, INTERRUPTED = 2, 141, 130


def main(argv: list[str] | None = None) -> int:
    """Run the command and return its exit code."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # print even if the encoding lacks ✓
    try:
        arguments = _parse(argv)
        code = int(arguments.run(arguments))
        if sys.stdout is not None:
            sys.stdout.flush()  # a full disk may show only here
        return code
    except BrokenPipeError:
        _close(sys.stdout)
        return PIPE
    except KeyboardInterrupt:
        return INTERRUPTED
    except Exception as error:
        try:
            _print_error(error)
        except OSError:  # standard error is full too; a traceback would exit with 1, which is an answer
            _close(sys.stderr)
        if isinstance(error, OSError):
            _close(sys.stdout)
        return CANNOT


def _print_error(error: Exception) -> None:
    """Print one sentence for each invalid setting, or the traceback of any other error."""
    if type(error).__name__ != "ValidationError" or getattr(error, "title", "") != "Settings":  # no import here: it may fail
        traceback.print_exc()
        return
    for wrong in error.errors(include_input=False, include_url=False):  # type: ignore[attr-defined]
        name = "_".join(map(str, wrong["loc"])).upper().removeprefix("POLHODE_")  # an alias has the prefix already
        place = f"POLHODE_{name}: " if name else ""  # an error of several settings names them itself
        print(f"polhode: {place}{wrong['msg'].removeprefix('Value error, ')}", file=sys.stderr)


def _close(stream: TextIO | None) -> None:
    """Redirect the stream to /dev/null, because Python flushes it once more on exit and would change the exit code."""
    if stream is not None:
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def _parse(argv: list[str] | None) -> argparse.Namespace:
    from service.cli import (
        database,
        export_assignment,
        grade,
        import_notebook,
        new_assignment,
        people,
        plan,
        publish,
        queue,
        verify,
    )

    parser = argparse.ArgumentParser(prog="polhode", description="Auto-graded course assignments for physics notebooks.")
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version and exit")
    commands = parser.add_subparsers(dest="command", required=True)
    serve = commands.add_parser("serve", help="start the server, with an embedded database unless POLHODE_DATABASE_URL is set")
    serve.add_argument("--host", help="address to listen on (POLHODE_HOST, default 127.0.0.1)")
    serve.add_argument("--port", type=int, help="port to listen on (POLHODE_PORT, default 8000)")
    serve.set_defaults(run=_serve)
    worker = commands.add_parser(
        "worker", help="grade for the server on this machine, or for the one with the database POLHODE_DATABASE_URL"
    )
    worker.add_argument(
        "--slots", type=grade.count, dest="workers", help="gradings at a time (POLHODE_WORKERS, default one per processor)"
    )
    worker.add_argument("--with-parent", type=int, metavar="PID", help="exit when the parent process PID exits")
    worker.set_defaults(run=_worker)
    chart = commands.add_parser("chart", help="measure the reference methods and chart their cost and where they fail")
    chart.add_argument("what", choices=["work-precision", "stability"], help="the chart to draw")
    chart.add_argument("--scene", action="append", metavar="NAME", help="only scenes whose name contains NAME; repeatable")
    chart.add_argument(
        "--out", type=Path, default=Path("charts"), metavar="DIR", help="folder for the CSV, JSON and SVG files (default charts)"
    )
    chart.set_defaults(run=_chart)
    mutants = commands.add_parser("mutants", help="grade mutants of the solution and list those that the checks misjudge")
    mutants.add_argument("assignment", nargs="?", default="rigid-body", help="slug or folder (default rigid-body)")
    mutants.add_argument("--most", type=grade.count, metavar="N", help="only the first N mutants")
    mutants.set_defaults(run=_mutants)
    for more in (grade, verify, new_assignment, import_notebook, publish, export_assignment, database, queue, plan, people):
        more.add(commands)
    commands.add_parser("doctor", help="check which sandbox features this machine supports").set_defaults(run=_doctor)
    commands.add_parser("assignments", help="list the assignments and their exercises").set_defaults(run=_assignments)
    return parser.parse_args(argv)


class _Version(argparse.Action):
    """Print the installed version and exit. argparse's own action needs the version on every start."""

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from importlib import metadata

        print(f"polhode {metadata.version('polhode')}")
        parser.exit()


def _serve(arguments: argparse.Namespace) -> int:
    from service.cli.serve import serve
    from service.settings import Settings

    given = {name: value for name in ("host", "port") if (value := getattr(arguments, name)) is not None}
    return serve(Settings(**given))


def _worker(arguments: argparse.Namespace) -> int:
    from service.sandbox.guest.lockdown import die_with_parent

    if arguments.with_parent is not None:
        die_with_parent(arguments.with_parent)
    from service import logs
    from service.settings import Settings
    from service.store.postgres.server import running_url
    from service.workers.pool import WorkerPool

    settings = Settings() if arguments.workers is None else Settings(workers=arguments.workers)
    logs.install(settings.log_level)
    if settings.workers < 1:
        print("polhode: this worker would grade nothing: set POLHODE_WORKERS or --slots to at least 1", file=sys.stderr)
        return 2
    if settings.database_url is None:
        settings = settings.model_copy(update={"database_url": running_url(settings.data)})
    if settings.database_url is None:
        print(
            f"polhode: no running server has its database in {settings.data}; start one, or set POLHODE_DATABASE_URL",
            file=sys.stderr,
        )
        return 2
    if reason := _wrong_schema(settings.database_url):
        print(f"polhode: {reason}", file=sys.stderr)
        return 2
    return WorkerPool(settings).run()


def _wrong_schema(url: str) -> str | None:
    """Return why this version cannot use the tables, or None if it can or the database does not answer yet."""
    from service.cli.database import run_async
    from service.store.database import WrongSchema, is_outage

    try:
        run_async(url, lambda database: database.ping())
    except WrongSchema as reason:
        return str(reason)
    except Exception as error:
        if not is_outage(error):
            raise
    return None


def _chart(arguments: argparse.Namespace) -> int:
    from service.grading.charts import write_stability, write_work_precision

    try:
        if arguments.what == "stability":
            print(f"written to {write_stability(arguments.scene, arguments.out)}/")
        else:
            print(f"written to {write_work_precision(arguments.scene, arguments.out)}/")
    except ValueError as error:
        print(f"polhode: {error}", file=sys.stderr)
        return 2
    except ModuleNotFoundError as missing:
        if missing.name != "numba":
            raise
        print("polhode: the reference methods need numba, which is not installed: pip install numba", file=sys.stderr)
        return 2
    return 0


def _mutants(arguments: argparse.Namespace) -> int:
    from exercises.assignment import InvalidAssignment, NoAssignment
    from exercises.catalogue import find
    from service.cli.mutants import NoMutants, grade_mutants, kill_rate, table
    from service.sandbox.result import SystemFault
    from service.sandbox.select import IsolationUnavailable

    try:
        results = list(grade_mutants(find(arguments.assignment), arguments.most))
    except (InvalidAssignment, NoAssignment, NoMutants, SystemFault, IsolationUnavailable) as error:
        print(f"polhode: cannot grade mutants: {error}", file=sys.stderr)
        return 2
    print(table(results), kill_rate(results), sep="\n")
    kinds = {(True, True): "WRONG, BUT ACCEPTED", (False, True): "right, but rejected", (False, False): "turned out correct"}
    for result in results:
        if result.misjudged or not result.wrong:
            print(f"{kinds[result.wrong, result.misjudged]}: {result.mutant.code}, {result.mutant.sentence}")
    return 1 if any(result.misjudged for result in results) else 0


def _doctor(arguments: argparse.Namespace) -> int:
    from service.cli.doctor import examine
    from service.settings import Settings

    lines, valid = examine(Settings().min_isolation, Settings().allow_root_guest)
    print("\n".join(lines))
    return 0 if valid else 2


def _assignments(arguments: argparse.Namespace) -> int:
    from exercises.catalogue import load_catalogue

    valid, invalid = load_catalogue()
    for assignment in valid.values():
        print(f"{assignment.slug}  {assignment.title}  (version {assignment.version})")
        for exercise in assignment.exercises:
            print(f"  {exercise.number}  {exercise.title}: {', '.join(exercise.functions)}")
    for error in invalid.values():
        print(f"polhode: {error}", file=sys.stderr)
    return CANNOT if invalid else 0


if __name__ == "__main__":
    sys.exit(main())
