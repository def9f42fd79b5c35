"""polhode as a wheel, made of the modules that run now, from a checkout as well as from an installed wheel."""

import shlex
from collections.abc import Iterator, Sequence
from importlib import metadata
from pathlib import Path

import ecp
import exercises
import reference
import service
from exercises import zipfiles
from exercises.assignment import Assignment
from exercises.zipfiles import zipped

FORM = b"Wheel-Version: 1.0\nGenerator: polhode\nRoot-Is-Purelib: true\nTag: py3-none-any\n"
METADATA = "Metadata-Version: 2.1\nName: polhode\nVersion: {version}\nLicense: MIT\nRequires-Python: >=3.11\n"
"""Without requirements, which in a checkout are those of the day it was installed: the lock has them all."""
KEPT = ("entry_points.txt", "licenses/LICENSE")  # of what the installed distribution tells of itself
LOCK = "requirements.lock"
HERE = Path(__file__).parent / "gradescope_zip"
LEFT_OUT = ("__pycache__", "kit", "samples")


def own_wheel(*outside: Path) -> tuple[str, bytes]:
    """Its file name and its bytes, the same for the same content; with assignments whose folders lie ``outside`` as if they were
    ours. Samples, which hold solutions, stay out.
    """
    own = metadata.distribution("polhode")
    info = f"polhode-{own.version}.dist-info"
    homes = [(Path(package.__path__[0]), package.__name__) for package in (ecp, exercises, reference, service)]
    homes += [(folder, f"exercises/{folder.name}") for folder in outside]
    files = {name: content for home, into in homes for name, content in _files(home, into)}
    files[f"service/cli/{HERE.name}/{LOCK}"] = lock()
    files |= {f"{info}/{name}": text.encode() for name in KEPT if (text := own.read_text(name)) is not None}
    files |= {f"{info}/METADATA": METADATA.format(version=own.version).encode(), f"{info}/WHEEL": FORM}
    return f"polhode-{own.version}-py3-none-any.whl", zipfiles.wheel(info, dict(sorted(files.items())))


def lock() -> bytes:
    """The hashed lock: of the checkout, or the copy that a wheel has beside this file."""
    checkout = HERE.parents[2]
    return (checkout / LOCK if (checkout / "pyproject.toml").is_file() else HERE / LOCK).read_bytes()


def _files(home: Path, into: str) -> Iterator[tuple[str, bytes]]:
    for path in home.rglob("*"):
        inside = path.relative_to(home)
        if path.is_file() and not any(part in LEFT_OUT or part.startswith(".") for part in inside.parts) and _belongs(path):
            yield f"{into}/{inside.as_posix()}", path.read_bytes()


def _belongs(path: Path) -> bool:
    """A notebook of another name than the students' may be the one with the solutions."""
    return path.suffix != ".ipynb" or path.name == "notebook.ipynb"


SCRIPTS = ("setup.sh", "run_autograder")
MARK = "{{ARGUMENTS}}"


def bundle(assignment: Assignment, numbers: Sequence[str] | None) -> bytes:
    """The zip, byte for byte the same for the same content; ``numbers``: of the exercises to grade, default those attempted."""
    arguments = ["--assignment", assignment.slug, *(part for number in numbers or () for part in ("--exercise", number))]
    files = {name: (HERE / name).read_text().replace(MARK, shlex.join(arguments)).encode() for name in SCRIPTS}
    ours = assignment.folder.is_relative_to(Path(exercises.__path__[0]))
    name, wheel = own_wheel(*([] if ours else [assignment.folder]))
    return zipped({**files, LOCK: lock(), name: wheel}, runnable=SCRIPTS)
