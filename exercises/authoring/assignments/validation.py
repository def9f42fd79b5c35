"""Validation of an assignment's declaration: all errors together, as sentences for the author."""

import ast
import functools
import math
import re
import traceback
from collections.abc import Collection, Iterable, Iterator
from pathlib import Path, PurePosixPath

from exercises.authoring.assignments.assignment import Assignment
from exercises.authoring.importing.reported_lines import ReportedLine
from polhode.judging.author_errors import AuthorError

HOST_ONLY = ("exercises", "reference", "service")  # packages that the guest and the students' kit do not have
# where an import of one of them, or of a neighbour, may be
ABSENT = re.compile(rf"\b({'|'.join(HOST_ONLY)})\b|\bfrom[\s\\]*\.")
MOST_DATA = 5_000_000  # bytes of a data file
MOST_MEMORY_MB = 8192  # that one submission may take of the server's memory


def errors(assignment: Assignment) -> list[str]:
    """Return the errors of the declaration, empty if there are none."""
    found = []
    if not isinstance(assignment.packages, tuple) or not all(
        isinstance(name, str) and name for name in assignment.packages
    ):
        found.append(f"packages is {assignment.packages!r}, not a tuple of names")
    if assignment.cpu_s is not None and not (assignment.cpu_s > 0 and math.isfinite(assignment.cpu_s)):
        found.append(f"cpu_s is {assignment.cpu_s}; it must be positive and finite")
    if assignment.memory_mb is not None and not (
        type(assignment.memory_mb) is int and 0 < assignment.memory_mb <= MOST_MEMORY_MB
    ):
        found.append(f"memory_mb is {assignment.memory_mb!r}; it must be whole MiB, at most {MOST_MEMORY_MB}")
    return [
        *found,
        *_imports(assignment),
        *_of_data(assignment),
        *_doubles(assignment),
        *_of_exercises(assignment),
        *_of_scenes(assignment),
    ]


def syntax_errors(folder: Path, valid: Collection[str] = ()) -> list[str]:
    """Return the syntax errors of every Python file in an assignment's folder except its samples and the
    ``valid`` ones.
    """
    found = []
    parts = (
        sorted(path.rglob("*.py")) if path.is_dir() else [path]
        for path in sorted(folder.glob("*"))
        if path.name != "samples"
    )
    for path in (path for part in parts for path in part):
        if path.suffix == ".py" and str(path) not in valid:
            try:
                compile(path.read_bytes(), str(path), "exec")
            except (SyntaxError, ValueError) as error:  # ValueError: zero bytes
                line = f" line {error.lineno}" if isinstance(error, SyntaxError) else ""
                found.append(f"{path.relative_to(folder)}{line}: {getattr(error, 'msg', error)}")
    return found


def _imports(assignment: Assignment) -> Iterator[str]:
    """Yield an error for each import in the Setup of a module that the guest does not have."""
    for node in ast.walk(_parsed(assignment.setup)) if ABSENT.search(assignment.setup) else ():
        if isinstance(node, ast.Import | ast.ImportFrom):
            of = "." * node.level + (node.module or "") if isinstance(node, ast.ImportFrom) else None
            for module in [of] if of else [alias.name for alias in node.names]:
                if module.split(".")[0] in ("", *HOST_ONLY):
                    yield (
                        f"the Setup line {node.lineno}: the sandbox and the kit have no {module}; import"
                        " numpy, scipy or polhode"
                    )


def _of_data(assignment: Assignment) -> Iterator[str]:
    if not isinstance(assignment.data, tuple) or not all(isinstance(name, str) for name in assignment.data):
        yield f"data is {assignment.data!r}, not a tuple of file names"
        return
    for name in assignment.data:
        path, file = PurePosixPath(name), assignment.folder / name
        if (
            path.is_absolute()
            or not path.name
            or {".."} & set(path.parts)
            or str(path) != name
            or path.parts[0] == "samples"
        ):
            yield (
                f"data file {name}: it must be a relative name such as pendulum.csv, without .. and not in"
                " samples/"
            )
        elif path.suffix in (".py", ".ipynb", ".toml"):
            yield (
                f"data file {name}: students get data files, so a {path.suffix} file, which may hold"
                " solutions, cannot be one"
            )
        elif not file.is_file():
            yield f"data file {name} is missing"
        elif file.stat().st_size > MOST_DATA:
            yield (
                f"data file {name} has {file.stat().st_size / 1e6:.1f} MB; at most {MOST_DATA / 1e6:g} MB are"
                " allowed"
            )


def _doubles(assignment: Assignment) -> Iterator[str]:
    exercises = assignment.exercises
    yield from (f"scene {name} is declared twice" for name in _twice(s.name for s in assignment.scenes))
    yield from (f"check id {id} is used twice" for id in _twice(c.id for e in exercises for c in e.checks))
    yield from (f"exercise {number} is declared twice" for number in _twice(e.number for e in exercises))
    yield from (
        f"figure {name} is declared twice" for name in _twice(f.name for e in exercises for f in e.figures)
    )
    yield from (
        f"animation {name} is declared twice"
        for name in _twice(a.name for e in exercises for a in e.animations)
    )


def _of_exercises(assignment: Assignment) -> Iterator[str]:
    scenes = {s.name: s for s in assignment.scenes}
    if not assignment.exercises:
        yield "it has no exercise"
    variables, names = (
        assignment.variables(),
        {name for e in assignment.exercises for name in e.function_names()},
    )
    for exercise in assignment.exercises:
        remedy = "a report shows labels, so give each its own"
        for label in _twice(check.label for check in exercise.checks if not isinstance(check, ReportedLine)):
            yield f"exercise {exercise.number}: several checks have the label {label!r}: {remedy}"
        asked = exercise.function_names()
        yield from (
            f"exercise {exercise.number}: the variable {v} is not in functions"
            for v in set(exercise.variables) - asked
        )
        both = sorted(asked & variables - set(exercise.variables))
        yield from (
            f"exercise {exercise.number}: {name} is a function here and a variable in another exercise"
            for name in both
        )
        strange = sorted(set(exercise.prerequisites) - names)
        yield from (
            f"exercise {exercise.number}: no exercise asks for its prerequisite {name}" for name in strange
        )
        yield from (
            f"exercise {exercise.number}: no scene {s}" for s in sorted(exercise.scenes() - set(scenes))
        )
        yield from (e for c in exercise.checks for e in c.errors())
        for motion in exercise.motions:
            if motion.scene in scenes and "R" not in scenes[motion.scene].returns:
                yield f"motion {motion.name}: scene {motion.scene} does not return R"


def _of_scenes(assignment: Assignment) -> Iterator[str]:
    names = [s.name for s in assignment.scenes]
    for at, scene in enumerate(assignment.scenes):
        if scene.after is not None and scene.after not in names[:at]:
            yield f"scene {scene.name} comes after {scene.after}, which is not declared before it"
        if not (scene.budget_s > 0 and math.isfinite(scene.budget_s)):
            yield f"scene {scene.name}: its budget is {scene.budget_s} s; it must be positive and finite"


@functools.lru_cache(maxsize=8)
def _parsed(source: str) -> ast.Module:
    """Return the syntax tree, empty if the source is invalid."""
    try:
        return ast.parse(source)
    except (SyntaxError, ValueError):
        return ast.Module([], [])


def _twice(names: Iterable[str]) -> list[str]:
    listed = list(names)
    return sorted({name for name in listed if listed.count(name) > 1})


def format_error(error: BaseException, folder: Path) -> str:
    """Return an error raised while importing the folder, with the line of the folder's code that raised
    it.
    """
    if isinstance(error, AuthorError):
        return str(error)
    message = f"{type(error).__name__}: {error}"
    own = [f for f in traceback.extract_tb(error.__traceback__) if Path(f.filename).is_relative_to(folder)]
    return (
        f"{Path(own[-1].filename).relative_to(folder)} line {own[-1].lineno}: {message}" if own else message
    )
