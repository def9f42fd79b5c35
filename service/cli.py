"""The command line, one subcommand a file in service/commands, but for those that need no database.

Exit codes of grade: 0 all ✓, 1 some ✗ or –, 2 our own failure; of mutants: 0 where we accept what is right and nothing else.
"""

import argparse
import json
import os
import secrets
import sys
import traceback
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from exercises.assignment import assignments
from service.commands import credentials, database, people, plan, queue


def main(argv: list[str] | None = None) -> int:
    """Run the command; its exit code."""
    parser = argparse.ArgumentParser(prog="polhode", description="Auto-graded course assignments for physics notebooks.")
    commands = parser.add_subparsers(dest="command", required=True)
    serve = commands.add_parser("serve", help="start the server, with an embedded database unless POLHODE_DATABASE_URL is set")
    serve.add_argument("--host", help="address to listen on (POLHODE_HOST, default 127.0.0.1)")
    serve.add_argument("--port", type=int, help="port to listen on (POLHODE_PORT, default 8000)")
    serve.set_defaults(run=_serve)
    worker = commands.add_parser("worker", help="grade for a server, on this machine or another: POLHODE_DATABASE_URL tells where")
    worker.add_argument("--slots", type=int, dest="workers", help="how many at a time (POLHODE_WORKERS, default one per processor)")
    worker.add_argument("--with-parent", type=int, metavar="PID", help="end when process PID, which started it, ends")
    worker.set_defaults(run=_worker)
    grade = commands.add_parser("grade", help="grade .py and .ipynb files here, without server and database")
    grade.add_argument("files", nargs="+", type=Path, metavar="FILE")
    grade.add_argument("--assignment", default="rigid-body", choices=sorted(assignments()), help="default rigid-body")
    grade.add_argument("--exercise", action="append", metavar="N", help="grade exercise N; repeatable; default: those attempted")
    grade.add_argument("--seed", type=int, default=None, help="draw the secret scenes from this seed, as a report names it")
    grade.add_argument("--json", action="store_true", help="print the reports as one JSON document and nothing else")
    grade.add_argument("--out", type=Path, metavar="DIR", help="write each report, its figures and contact sheets into DIR")
    grade.add_argument("--sweep", action="store_true", help="also chart the function's own speed against accuracy")
    grade.set_defaults(run=_grade)
    chart = commands.add_parser("chart", help="measure the reference methods and draw what they cost and where they fail")
    chart.add_argument("what", choices=["work-precision", "stability"])
    chart.add_argument("--scene", action="append", metavar="NAME", help="only scenes whose name holds NAME; repeatable")
    chart.add_argument(
        "--out", type=Path, default=Path("charts"), metavar="DIR", help="folder for CSV, JSON and SVG (default charts)"
    )
    chart.set_defaults(run=_chart)
    mutants = commands.add_parser("mutants", help="grade wrong functions by the dozen and tell which of them the checks accept")
    mutants.add_argument("assignment", nargs="?", default="rigid-body", help="slug or folder (default rigid-body)")
    mutants.add_argument("--most", type=int, metavar="N", help="only the first N")
    mutants.set_defaults(run=_mutants)
    for more in (database, queue, plan, people, credentials):
        more.add(commands)
    commands.add_parser("doctor", help="tell what this machine gives to shut submissions in with").set_defaults(run=_doctor)
    commands.add_parser("assignments", help="list the assignments").set_defaults(run=_assignments)
    arguments = parser.parse_args(argv)
    try:
        return int(arguments.run(arguments))
    except ValidationError as error:
        for wrong in error.errors(include_input=False, include_url=False):
            print(f"polhode: POLHODE_{'_'.join(map(str, wrong['loc'])).upper()}: {wrong['msg']}", file=sys.stderr)
        return 2
    except BrokenPipeError:  # whoever read us has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except KeyboardInterrupt:
        return 130


def _serve(arguments: argparse.Namespace) -> int:
    from service.serve import serve
    from service.settings import Settings

    given = {name: value for name in ("host", "port") if (value := getattr(arguments, name)) is not None}
    return serve(Settings(**given))


def _worker(arguments: argparse.Namespace) -> int:
    from service.sandbox.guest.lockdown import die_with_parent

    if arguments.with_parent is not None:
        die_with_parent(arguments.with_parent)
    from service import logs
    from service.settings import Settings
    from service.store.postgres import running_url
    from service.workers.crew import Crew

    settings = Settings() if arguments.workers is None else Settings(workers=arguments.workers)
    logs.install(settings.log_level)
    if settings.database_url is None:
        settings = settings.model_copy(update={"database_url": running_url(settings.data)})
    if settings.database_url is None:
        print(f"polhode: no server has its database in {settings.data}, and POLHODE_DATABASE_URL is not set", file=sys.stderr)
        return 2
    return Crew(settings).run()


def _chart(arguments: argparse.Namespace) -> int:
    from service.charts import write_stability, write_work_precision

    try:
        if arguments.what == "stability":
            print(f"written to {write_stability(arguments.out)}/")
        else:
            print(f"written to {write_work_precision(arguments.scene, arguments.out)}/")
    except ValueError as error:
        print(f"polhode: {error}", file=sys.stderr)
        return 2
    except ModuleNotFoundError as missing:
        if missing.name != "numba":
            raise
        print("polhode: the reference methods are compiled with numba, which is not installed here", file=sys.stderr)
        return 2
    return 0


def _mutants(arguments: argparse.Namespace) -> int:
    from service.mutants import OURS, fates, table

    try:
        found = list(fates(assignments()[arguments.assignment.replace("_", "-")], arguments.most))
    except (KeyError, ModuleNotFoundError) as error:
        print(f"polhode: no mutants for {error}", file=sys.stderr)
        return 2
    print(table(found))
    for fate in found:
        if fate.wrong == (OURS in fate.accepted):
            print(f"{'WRONG, BUT ACCEPTED' if fate.wrong else 'right, but refused'}: {fate.mutant.kind}, {fate.mutant.name}")
    return 1 if any(f.wrong == (OURS in f.accepted) for f in found) else 0


def _doctor(arguments: argparse.Namespace) -> int:
    from service.doctor import examine
    from service.settings import Settings

    lines, sound = examine(Settings().min_tier)
    print("\n".join(lines))
    return 0 if sound else 2


def _assignments(arguments: argparse.Namespace) -> int:
    for assignment in assignments().values():
        print(f"{assignment.slug}  {assignment.title}  (version {assignment.version})")
        for exercise in assignment.exercises:
            print(f"  {exercise.number}  {exercise.title}: {', '.join(exercise.functions)}")
    return 0


def _grade(arguments: argparse.Namespace) -> int:
    from ecp.document import document
    from service.batch import grade_files
    from service.grading.grade import UnknownExercise
    from service.grading.submission import BadSubmission
    from service.sandbox.choose import WallsMissing
    from service.sandbox.seen import Fault

    seed = secrets.randbits(48) if arguments.seed is None else arguments.seed
    reports: list[dict[str, Any]] = []
    try:
        for file, result in grade_files(
            arguments.files, assignments()[arguments.assignment], arguments.exercise, seed, arguments.out, swept=arguments.sweep
        ):
            if isinstance(result, BadSubmission):
                reports.append({"file": str(file), "report": None, "error": str(result)})
                print(f"polhode: {file}: {result}", file=sys.stderr)
                continue
            reports.append({"file": str(file), "report": document(result)})
            if not arguments.json:
                print(f"== {file}\n{result.text()}", flush=True)
    except (UnknownExercise, WallsMissing, Fault, OSError) as error:
        print(f"polhode: {error}", file=sys.stderr)
        return 2
    except Exception:
        traceback.print_exc()
        return 2
    if arguments.json:
        print(json.dumps({"reports": reports}, ensure_ascii=False, allow_nan=False))
    return 0 if all(r["report"] and r["report"]["passed"] for r in reports) else 1


if __name__ == "__main__":
    sys.exit(main())
