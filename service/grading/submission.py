"""A submission: read from a file or from a JSON document, the body of a request to the API or a file for
``polhode grade``, and its cells of source text. Python is parsed only in the sandbox.
"""

import hashlib
import json
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import PurePath

from polhode.judging.outcome import SceneEnd
from polhode.notebook.strip_outputs import is_notebook, strip_outputs
from polhode.report.student_line import FRAME
from service.sandbox.job import Cell

KIB, MIB = 2**10, 2**20
MOST_CELLS = 500
MOST_NAME = 120
PYTHON_FILE = "submission.py"
PLAIN_NAME = re.compile(r"(?!plays\.py)[\w .()+-]{1,80}\.py")  # plays.py is a name of the sandbox's own
SUFFIXES = (".py", ".ipynb")
RENAME = "submit a .py or .ipynb file; if it holds Python, give it a name that ends in .py"
NOT_A_NOTEBOOK = (
    "this file is named .ipynb but is not a Jupyter notebook (format 4): save it in Jupyter, or, if it is"
    " Python, name it .py"
)


class BadSubmission(ValueError):
    """The file is no valid submission. The message is for the student.

    ``pointer`` is the JSON pointer (RFC 6901) to the offending part of a request.
    """

    def __init__(self, sentence: str, pointer: str = "/source") -> None:
        super().__init__(sentence)
        self.pointer = pointer


class TooLarge(BadSubmission):
    """The file exceeds a size limit."""


class BadDocument(BadSubmission):
    """The document does not have the fields of a submission; ``pointer`` is empty if it is not even JSON."""


@dataclass(frozen=True)
class SizeLimits:
    """The most bytes of an uploaded file, and of the source that remains without a notebook's outputs."""

    upload: int = 20 * MIB
    source: int = 256 * KIB


DEFAULT_SIZES = SizeLimits()


@dataclass(frozen=True)
class Submission:
    """Source text, its file name, and the requested ``exercises`` (None: those that it attempts). A notebook,
    by its name or its text, is kept without outputs.
    """

    source: str
    filename: str = PYTHON_FILE
    exercises: Sequence[str] | None = None

    @classmethod
    def from_bytes(cls, data: bytes, filename: str, limits: SizeLimits = DEFAULT_SIZES) -> "Submission":
        """Read an uploaded file.

        Raises TooLarge, and BadSubmission if the file is not text, empty, or named like a notebook but not
        one.
        """
        if len(data) > limits.upload:
            raise TooLarge(upload_too_large(limits))
        try:
            source = data.decode("utf-8-sig")
        except UnicodeDecodeError:
            raise BadSubmission(f"{filename} is not a text file (UTF-8): save it as UTF-8") from None
        if "\x00" in source:
            raise BadSubmission(f"{filename} is not a text file (it contains zero bytes): save it as UTF-8")
        submission = cls(_without_outputs(source, filename, limits), _name(filename))
        if len(submission.cells()) > MOST_CELLS:
            raise BadSubmission(f"{filename} has more than {MOST_CELLS} code cells: submit fewer cells")
        if not any(cell.source.strip() for cell in submission.cells()):
            raise BadSubmission(f"{filename} contains no code: add the functions to be graded")
        return submission

    @classmethod
    def from_json(cls, data: bytes, limits: SizeLimits = DEFAULT_SIZES) -> "Submission":
        """Read a document with a ``source``, and optionally ``filename`` and ``exercises``.

        Raises BadSubmission if it is invalid.
        """
        try:
            document = json.loads(data)
        except (ValueError, RecursionError):
            raise BadDocument("the body is not valid JSON", "") from None
        if not isinstance(document, dict) or not isinstance(document.get("source"), str):
            raise BadDocument('the body must be a JSON object with a string "source"')
        if unknown := sorted(set(document) - {"source", "exercises", "filename"}):
            raise BadDocument(f"unknown field {unknown[0]}: remove it", f"/{unknown[0]}")
        name = check_filename(document.get("filename", PYTHON_FILE), "/filename")
        submission = cls.from_bytes(document["source"].encode("utf-8", "replace"), name, limits)
        return replace(submission, exercises=check_exercises(document.get("exercises")))

    @property
    def sha256(self) -> str:
        """The SHA-256 of the source as UTF-8, in hexadecimal digits."""
        return hashlib.sha256(self.source.encode()).hexdigest()

    def cells(self) -> tuple[Cell, ...]:
        """Return the code cells of a notebook, or the whole file as one cell."""
        if not is_notebook(self.source, self.filename):
            return (Cell(cell_name(self.filename), self.source),)
        return _notebook_cells(self.source)


def cell_name(filename: str) -> str:
    """Return the name of a Python file in tracebacks: its own if that is plain."""
    return filename if PLAIN_NAME.fullmatch(filename) else PYTHON_FILE


def check_filename(value: object, pointer: str) -> str:
    """Return a printable file name. Raises BadSubmission, with ``pointer``, unless it ends in .py or .ipynb,
    in capitals or not.
    """
    name = "".join(c for c in value if c.isprintable()) if isinstance(value, str) else ""
    if not name.lower().endswith(SUFFIXES):
        raise BadSubmission(f"cannot grade the file {name[:80]!r}: {RENAME}", pointer)
    return name


def check_exercises(numbers: object) -> list[str] | None:
    """Return the exercise numbers, sorted. Raises BadDocument unless they are None or a list of strings."""
    if numbers is None:
        return None
    if not isinstance(numbers, list) or not numbers or not all(isinstance(n, str) for n in numbers):
        raise BadDocument('"exercises" must be a non-empty list of exercise numbers as strings', "/exercises")
    return sorted(set(numbers))


def upload_too_large(limits: SizeLimits) -> str:
    """Return the message for a file that exceeds ``limits.upload``."""
    remedy = (
        "clear the outputs of the notebook (in Jupyter: Edit, Clear Outputs of All Cells), save it and submit"
        " it again"
    )
    return f"the submission is larger than {limits.upload / MIB:g} MiB: {remedy}"


def _without_outputs(source: str, filename: str, limits: SizeLimits) -> str:
    """Return the source, of a notebook without its outputs. Raises BadSubmission."""
    notebook = is_notebook(source, filename)
    try:
        source = strip_outputs(source) if notebook else source
    except ValueError:
        raise BadSubmission(NOT_A_NOTEBOOK) from None
    if (size := len(source.encode())) > limits.source:
        counted = "without outputs it" if notebook else "it"
        allowed = (
            f"{counted} has {math.ceil(size / KIB)} KiB and at most {limits.source / KIB:g} KiB are accepted"
        )
        raise TooLarge(
            f"the submission is too large: {allowed}; remove data and pictures from the code and text, or"
            " submit less"
        )
    return source


def _name(filename: str) -> str:
    """Return the last part of a file name, printable and at most MOST_NAME characters."""
    name = "".join(c for c in PurePath(filename).name if c.isprintable())
    return name[-MOST_NAME:] or PYTHON_FILE


def _notebook_cells(source: str) -> tuple[Cell, ...]:
    try:
        notebook = json.loads(source)
        code = [
            (_text(c["source"]), str(c.get("id", ""))) for c in notebook["cells"] if c["cell_type"] == "code"
        ]
    except (ValueError, KeyError, TypeError, RecursionError):
        raise BadSubmission(NOT_A_NOTEBOOK) from None
    return tuple(Cell(f"cell {number}", text, id=id) for number, (text, id) in enumerate(code, start=1))


def _text(source: str | list[str]) -> str:
    return source if isinstance(source, str) else "".join(source)


@dataclass(frozen=True)
class SourceLocation:
    """A line number, from 1, of a cell named as in a traceback."""

    cell: str
    line: int


def source_locations(scene_end: SceneEnd) -> list[SourceLocation]:
    """Return the submission's lines in a traceback, outermost first. The exception's own text is not read."""
    found = []
    for line in (scene_end.traceback or "").split("\n"):
        if line and not line[0].isspace():
            break
        if frame := FRAME.match(line):
            found.append(SourceLocation(frame[1], int(frame[2][:9])))
    return found
