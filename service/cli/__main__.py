"""The command-line entry point ``polhode``: one module for each group of commands.

Only the module of the given command is imported, and only its arguments are added. A failing import exits
with code 2, because codes 0 and 1 are answers: of ``grade``, all checks ✓ or not; of ``mutants``, whether the
checks accept exactly the right functions. Code 141 means that standard output was closed early.
"""

import argparse
import io
import os
import sys
from contextlib import suppress
from importlib import import_module
from typing import Any, NamedTuple

from service.cli.errors import print_error

CANNOT, PIPE, INTERRUPTED = 2, 141, 130


class Command(NamedTuple):
    """The module of a command, whose function ``add_COMMAND`` adds the arguments to the parser, and what the
    command does.
    """

    module: str
    help: str


COMMANDS = {
    "serve": Command(
        "serve", help="start the server, with an embedded database unless POLHODE_DATABASE_URL is set"
    ),
    "worker": Command(
        "worker",
        help="grade for the server on this machine, or for the one with the database POLHODE_DATABASE_URL",
    ),
    "chart": Command(
        "chart", help="measure what accuracy costs with the reference methods and where they fail"
    ),
    "mutants": Command(
        "mutants", help="grade mutants of the solution and list those that the checks misjudge"
    ),
    "grade": Command("grade", help="grade .py and .ipynb files on this machine, without server or database"),
    "verify": Command(
        "verify.command", help="grade the samples of assignments and compare with their expected reports"
    ),
    "new-assignment": Command("scaffolding", help="create an assignment of two working exercises to edit"),
    "import-notebook": Command(
        "import_notebook",
        help=(
            "make an assignment of a published notebook: its validation cells are run and judged again,"
            " without points"
        ),
    ),
    "publish": Command(
        "publish", help="write the students' notebook of an assignment, without solutions, to SLUG.ipynb"
    ),
    "export": Command("gradescope_bundle", help="export an assignment for another grading system"),
    "db": Command("database", help="upgrade, back up, restore and check the database"),
    "queue": Command(
        "queue", help="show waiting and running gradings (refreshes every second on a terminal)"
    ),
    "regrade": Command(
        "queue", help="grade submissions again, after all first gradings; results apply immediately"
    ),
    "assign": Command(
        "queue",
        help=(
            "set or show deadline, grace period, submission limit and weight; options not given stay"
            " unchanged"
        ),
    ),
    "roster": Command(
        "people", help="import people from a CSV file, or list the people of the course in that format"
    ),
    "token": Command("people", help="create, list and revoke tokens"),
    "password": Command(
        "people", help="set a person's password, typed at a prompt or read from standard input"
    ),
    "unlink": Command("people", help="disconnect a person from the account at the OpenID provider"),
    "doctor": Command("doctor", help="check which sandbox features this machine supports"),
    "assignments": Command("scaffolding", help="list the assignments and their exercises"),
}


class _Version(argparse.Action):
    def __call__(self, parser: argparse.ArgumentParser, *of_this_use: Any) -> None:
        from importlib.metadata import version  # 20 ms, which the commands save

        print(f"polhode {version('polhode')}")
        parser.exit()


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
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version and exit")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    given = [name for name in argv[:1] if name in COMMANDS]
    for name in given or COMMANDS:
        command = commands.add_parser(name, help=COMMANDS[name].help)
        if given:
            getattr(import_module(f"service.cli.{COMMANDS[name].module}"), f"add_{name.replace('-', '_')}")(
                command
            )
    return parser.parse_args(argv)


if __name__ == "__main__":
    sys.exit(main())
