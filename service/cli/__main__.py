"""The command-line entry point ``polhode``.

Only the module of the given command is imported, and only its arguments are added. A failing import exits
with code 2, because codes 0 and 1 are answers: of ``grade``, all checks ✓ or not; of ``mutants``, whether the
checks accept exactly the right functions. Code 141 means that standard output was closed early.
"""

import argparse
import gc
import io
import os
import sys
from contextlib import suppress
from importlib import import_module, metadata

from service.cli.errors import print_error

CANNOT, PIPE, INTERRUPTED = 2, 141, 130

COMMANDS = {
    "serve": (
        "server.serve",
        "start the server, with an embedded database unless POLHODE_DATABASE_URL is set",
    ),
    "worker": (
        "server.worker",
        "grade for the server on this machine, or for the one with the database POLHODE_DATABASE_URL",
    ),
    "chart": ("grading.chart", "measure what accuracy costs with the reference methods and where they fail"),
    "mutants": ("authoring.mutants", "grade mutants of the solution and list those that the checks misjudge"),
    "grade": ("grading.grade", "grade .py and .ipynb files on this machine, without server or database"),
    "verify": (
        "authoring.verify.command",
        "grade the samples of assignments and compare with their expected reports",
    ),
    "new-assignment": (
        "authoring.new_assignment",
        "create an assignment of two working exercises to edit",
    ),
    "import-notebook": (
        "authoring.import_notebook",
        "make an assignment of a published notebook: its validation cells are run and judged again,"
        " without points",
    ),
    "publish": (
        "authoring.publish",
        "write the students' notebook of an assignment, without solutions, to SLUG.ipynb",
    ),
    "export": ("grading.gradescope_export", "export an assignment for another grading system"),
    "db": ("server.database", "upgrade, back up, restore and check the database"),
    "queue": ("server.queue", "show waiting and running gradings (refreshes every second on a terminal)"),
    "regrade": (
        "server.queue",
        "grade submissions again, after all first gradings; results apply immediately",
    ),
    "assign": (
        "server.assign",
        "publish an assignment; set or show deadline, grace period, submission limit and weight; options not"
        " given stay unchanged",
    ),
    "roster": (
        "server.people",
        "import people from a CSV file, or list the people of the course in that format",
    ),
    "token": ("server.people", "create, list and revoke tokens"),
    "password": (
        "server.people",
        "set a person's password, typed at a prompt or read from standard input",
    ),
    "unlink": ("server.people", "disconnect a person from the account at the OpenID provider"),
    "doctor": ("server.doctor", "check which sandbox features this machine supports"),
    "assignments": ("authoring.new_assignment", "list the assignments and their exercises"),
}
"""By the name of a command: the module whose function ``add_COMMAND`` adds its arguments to a parser, and
what the command does.
"""


def add_arguments(name: str, parser: argparse.ArgumentParser) -> None:
    """Import the module of a command and add the command's arguments."""
    gc.disable()  # collections during the imports would take a fifth of the time of grading a file
    try:
        module = import_module(f"service.cli.{COMMANDS[name][0]}")
    finally:
        gc.freeze()
        gc.enable()
    getattr(module, f"add_{name.replace('-', '_')}")(parser)


def main(argv: list[str] | None = None) -> int:
    """Run the command and return its exit code: the one that its function returns, 0 if that is None."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # print even if the encoding lacks ✓
    try:
        arguments = _parse(sys.argv[1:] if argv is None else argv)
        code = int(arguments.run(arguments) or 0)
        if sys.stdout is not None:
            sys.stdout.flush()  # a full disk may show only here
    except BrokenPipeError:
        code = PIPE
    except KeyboardInterrupt:
        code = INTERRUPTED
    except Exception as error:
        with suppress(
            OSError
        ):  # standard error may be full too; a traceback would exit with 1, which is an answer
            print_error(error)
        code = CANNOT
    for stream in filter(None, (sys.stdout, sys.stderr)):
        try:
            stream.flush()
        except OSError:  # Python flushes it once more on exit, which would change the exit code
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
    return code


def _parse(argv: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="polhode", description="Auto-graded course assignments for physics notebooks."
    )
    version = f"polhode {metadata.version('polhode')}"
    parser.add_argument("--version", action="version", version=version, help="print the version and exit")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    given = [name for name in argv[:1] if name in COMMANDS]
    for name in given or COMMANDS:
        command = commands.add_parser(name, help=COMMANDS[name][1])
        if given:
            add_arguments(name, command)
    return parser.parse_args(argv)


if __name__ == "__main__":
    sys.exit(main())
