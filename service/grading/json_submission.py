"""A submission as a JSON document: the body of a request to the API, or a file for ``polhode grade``."""

import json
from dataclasses import dataclass

from service.grading.submission import PYTHON_FILE, BadSubmission, SizeLimits, Submission

SUFFIXES = (".py", ".ipynb")
RENAME = "submit a .py or .ipynb file; if it holds Python, give it a name that ends in .py"


class BadDocument(BadSubmission):
    """The document does not have the fields of a submission; ``pointer`` is empty if it is not even JSON."""


@dataclass(frozen=True)
class ParsedSubmission:
    """A valid submission and the requested exercises (None: those it attempts)."""

    submission: Submission
    exercises: list[str] | None


def read_json(data: bytes, limits: SizeLimits) -> ParsedSubmission:
    """Return the submission in a document with a ``source``, and optionally ``filename`` and ``exercises``.

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
    submission = Submission.from_bytes(document["source"].encode("utf-8", "replace"), name, limits)
    return ParsedSubmission(submission, check_exercises(document.get("exercises")))


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
