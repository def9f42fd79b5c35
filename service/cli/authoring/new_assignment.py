"""The commands ``polhode assignments`` and ``new-assignment``, which copies the folder template."""

import argparse
import json
import keyword
import re
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path

from exercises.authoring.assignments import catalogue, course_packages
from exercises.authoring.importing.importing import quoted
from service.cli.errors import CommandError

TEMPLATE = Path(__file__).parent / "template"
TITLE = "The pendulum"
LONGEST, MOST_TITLE = 60, 100


class CannotScaffold(CommandError):
    """The folder cannot be created; the message says why."""


def add_assignments(parser: argparse.ArgumentParser) -> None:
    """Set the function of the command, which has no arguments."""
    parser.set_defaults(run=_assignments)


def add_new_assignment(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "slug", metavar="SLUG", help="lower-case letters, digits and single dashes, such as driven-pendulum"
    )
    parser.add_argument("--title", help="title for students; default: the slug's words")
    parser.add_argument(
        "--into",
        type=Path,
        metavar="FOLDER",
        help="parent folder; default: where this installation looks for assignments",
    )
    parser.set_defaults(run=_new)


def _assignments(arguments: argparse.Namespace) -> int:
    valid, invalid = catalogue.load_catalogue()
    for assignment in valid.values():
        print(f"{assignment.slug}  {assignment.title}  (version {assignment.version})")
        for exercise in assignment.exercises:
            print(f"  {exercise.number}  {exercise.title}: {', '.join(exercise.functions)}")
    wrong = [*map(str, invalid.values()), *course_packages.errors()]
    for sentence in [*wrong, *course_packages.remarks()]:
        print(f"polhode: {sentence}", file=sys.stderr)
    return 2 if wrong else 0


def _new(arguments: argparse.Namespace) -> None:
    slug, into = arguments.slug, arguments.into or catalogue.default_folder()
    title = arguments.title if arguments.title is not None else slug.replace("-", " ").capitalize()
    try:
        if into is None:
            raise CannotScaffold(
                f"cannot write into the installed package: give --into FOLDER, and set {catalogue.SETTING} to"
                " FOLDER"
            )
        folder = scaffold(slug, title, into)
    except (CannotScaffold, OSError) as error:
        raise CommandError(f"{error}; nothing was created") from error
    print(f"created {folder}")
    if folder.resolve() not in [known.resolve() for known in catalogue.folders()]:
        print(
            "to make it known to the other commands and the server: export"
            f" {catalogue.SETTING}={into.resolve()}"
        )
    print(f"next: polhode verify {folder}")


def scaffold(slug: str, title: str, into: Path) -> Path:
    """Create the folder of a new assignment within ``into`` and return it. Raises as ``created`` does."""
    in_file = {
        catalogue.DECLARATION: (quoted(TITLE), quoted(title)),
        "notebook.ipynb": (f"# {TITLE}", f"# {json.dumps(_markdown(title), ensure_ascii=False)[1:-1]}"),
    }
    files = {}
    for name, (old, new) in in_file.items():
        text = (TEMPLATE / name).read_text(encoding="utf-8")
        assert text.count(old) == 1
        files[name] = text.replace(old, new).encode()
    return created(slug, title, into, files)


def created(slug: str, title: str, into: Path, files: Mapping[str, bytes]) -> Path:
    """Create the folder of an assignment with these ``files`` within ``into``, completely or not at all, and
    return it.

    Raises CannotScaffold for an invalid or taken slug or title, OSError if writing fails.
    """
    if not re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)*", slug) or len(slug) > LONGEST:
        raise CannotScaffold(
            f"invalid slug {slug!r}: use lower-case letters and digits, with single dashes between words,"
            " such as driven-pendulum"
        )
    if keyword.iskeyword(slug):
        raise CannotScaffold(f"invalid slug {slug}: it is a Python keyword")
    if catalogue.is_taken(slug):
        raise CannotScaffold(f"the slug {slug} is taken by an assignment or module: choose another")
    if not title.strip() or not title.isprintable() or len(title) > MOST_TITLE:
        raise CannotScaffold(f"invalid title: use one line of at most {MOST_TITLE} printable characters")
    name = slug.replace("-", "_")
    goal = into / name
    if (
        goal.is_symlink() or goal.exists() or goal.with_suffix(".py").exists()
    ):  # also a broken link, or a module of that name
        raise CannotScaffold(f"{goal} already exists")
    into.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(
        prefix=".new-assignment-", dir=into
    ) as made:  # hidden, so that it is not discovered
        folder = Path(made) / name
        folder.mkdir()
        for file, content in files.items():
            (folder / file).parent.mkdir(exist_ok=True)
            (folder / file).write_bytes(content)
        folder.rename(goal)
    return goal


def _markdown(text: str) -> str:
    """Return plain text as Markdown that shows it."""
    return re.sub(r"([\\`*_{}\[\]<>#$|])", r"\\\1", text)
