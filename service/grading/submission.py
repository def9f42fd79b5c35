"""A submission as cells of source text. Python is parsed only in the sandbox."""

import hashlib
import json
import math
import re
from dataclasses import dataclass
from pathlib import PurePath

from ecp.notebook.outputs import is_notebook, strip_outputs
from ecp.outcome import FRAME, SceneEnd
from service.sandbox.job import Cell

KIB, MIB = 2**10, 2**20
MOST_CELLS = 500
MOST_NAME = 120
PYTHON_FILE = "submission.py"
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


@dataclass(frozen=True)
class SizeLimits:
    """The most bytes of an uploaded file, and of the source that remains without a notebook's outputs."""

    upload: int = 20 * MIB
    source: int = 256 * KIB


DEFAULT_SIZES = SizeLimits()


@dataclass(frozen=True)
class Submission:
    """Source text and its file name. A notebook, by its name or its text, is kept without outputs."""

    source: str
    filename: str = PYTHON_FILE

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

    @property
    def sha256(self) -> str:
        """The SHA-256 of the source as UTF-8, in hexadecimal digits."""
        return hashlib.sha256(self.source.encode()).hexdigest()

    def cells(self) -> tuple[Cell, ...]:
        """Return the code cells of a notebook, or the whole file as one cell."""
        if not is_notebook(self.source, self.filename):
            return (Cell(PYTHON_FILE, self.source),)
        return _notebook_cells(self.source)


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


BREAK = re.compile(r"\r\n|\r|\n")  # Python's line breaks; a form feed, for example, is none


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
