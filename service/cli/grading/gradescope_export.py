"""The command ``polhode export``: the autograder zip for Gradescope, with polhode and its kit as wheels built
from the running modules.

The modules can come from a checkout or an installed wheel.
"""

import argparse
import shlex
from collections.abc import Iterator, Sequence
from importlib import metadata
from pathlib import Path

import exercises
import reference
import service
from exercises.authoring.assignments.assignment import Assignment
from exercises.authoring.assignments.catalogue import DECLARATION
from exercises.authoring.importing.validation_words import COURSE_FOLDER
from exercises.authoring.publishing import wheel as kit
from exercises.authoring.publishing import zipfiles
from exercises.authoring.publishing.zipfiles import zipped
from polhode.client.kit_hash import WHEEL
from service.cli.arguments import add_exercise
from service.cli.grading.find_assignment import find_assignment
from service.cli.output_file import write
from service.grading.grade import select

METADATA = "Metadata-Version: 2.1\nName: polhode\nVersion: {version}\nLicense: MIT\nRequires-Python: >=3.11\n"
"""It lists no requirements: those of a checkout may be outdated, and the lock file has all of them."""
KEPT = ("entry_points.txt", "licenses/LICENSE")  # copied from the installed distribution's metadata
LOCK = "requirements.lock"  # in the zip and in the wheel
HERE = Path(__file__).parent / "gradescope_zip"
LEFT_OUT = ("__pycache__", "kit", "samples")
SCRIPTS = ("setup.sh", "run_autograder")
MARK = "{{ARGUMENTS}}"


def add_export(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    forms = parser.add_subparsers(dest="form", required=True)
    gradescope = forms.add_parser("gradescope", help="write the autograder zip to upload to Gradescope")
    gradescope.add_argument("--assignment", metavar="SLUG", help="default: the only assignment")
    add_exercise(gradescope)
    gradescope.add_argument("--out", type=Path, required=True, metavar="FILE.zip", help="zip file to write")
    gradescope.set_defaults(run=_gradescope)


def _gradescope(arguments: argparse.Namespace) -> None:
    assignment = find_assignment(arguments.assignment, [])
    select(assignment, arguments.exercise)
    write(arguments.out, bundle(assignment, arguments.exercise))
    points = assignment.max_points(arguments.exercise)
    print(
        f"written to {arguments.out}: upload it as the autograder and set the autograder points to {points}"
    )


def own_wheel(*outside: Path) -> tuple[str, bytes]:
    """Return the file name and the bytes of the wheel, which are reproducible. Samples, which hold solutions,
    are left out.

    The assignments in the folders ``outside`` are added to the package ``exercises``.
    """
    own = metadata.distribution("polhode")
    info = f"polhode-{own.version}.dist-info"
    homes = [(Path(package.__path__[0]), package.__name__) for package in (exercises, reference, service)]
    homes += [(folder, f"exercises/{folder.name}") for folder in outside]
    homes += [(folder.parent / COURSE_FOLDER, f"exercises/{COURSE_FOLDER}") for folder in outside]
    files = {name: content for home, into in homes for name, content in _files(home, into)}
    files[f"service/cli/grading/{HERE.name}/{LOCK}"] = lock()
    files |= {f"{info}/{name}": text.encode() for name in KEPT if (text := own.read_text(name)) is not None}
    about = METADATA.format(version=own.version)
    return f"polhode-{own.version}-py3-none-any.whl", zipfiles.wheel(info, about, dict(sorted(files.items())))


def lock() -> bytes:
    """Return the hashed requirements, from the checkout or from the copy in the installed wheel."""
    in_checkout = HERE.parents[3] / "requirements" / "runtime.lock"
    return (in_checkout if in_checkout.is_file() else HERE / LOCK).read_bytes()


def _files(home: Path, into: str) -> Iterator[tuple[str, bytes]]:
    for path in home.rglob("*"):
        inside = path.relative_to(home)
        if (
            path.is_file()
            and not any(part in LEFT_OUT or part.startswith(".") for part in inside.parts)
            and _is_packaged(path)
        ):
            yield f"{into}/{inside.as_posix()}", path.read_bytes()


def _is_packaged(path: Path) -> bool:
    """Return False for a notebook that the declaration beside it does not name: it may contain solutions."""
    declaration = path.parent / DECLARATION
    return path.suffix != ".ipynb" or (
        declaration.is_file() and path.name in declaration.read_text(encoding="utf-8")
    )


def bundle(assignment: Assignment, numbers: Sequence[str] | None) -> bytes:
    """Return the zip, byte-for-byte reproducible, that grades the exercises ``numbers`` (None: the attempted
    ones).
    """
    arguments = [
        "--assignment",
        assignment.slug,
        *(part for number in numbers or () for part in ("--exercise", number)),
    ]
    files = {
        name: (HERE / name).read_text().replace(MARK, shlex.join(arguments)).encode() for name in SCRIPTS
    }
    included = assignment.folder.is_relative_to(Path(exercises.__path__[0]))
    name, wheel = own_wheel(*([] if included else [assignment.folder]))
    return zipped({**files, LOCK: lock(), WHEEL: kit.wheel(), name: wheel}, runnable=SCRIPTS)
