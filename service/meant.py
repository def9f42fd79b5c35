"""Which assignment files are for, where nobody says so: never a guess, as a wrong one would cost every point."""

import re
from collections.abc import Sequence
from pathlib import Path

from exercises.assignment import Assignment, NoAssignment, find, found
from exercises.folders import folders, slug_of
from service.grading.submission import MOST_BYTES


def meant(slug: str | None, files: Sequence[Path]) -> Assignment:
    """The assignment ``slug``; or, for None, that whose folder the files lie in, the only one there is, or, if none is broken, the
    only one whose functions they name. NoAssignment where that is not one, InvalidAssignment for a broken one.
    """
    if slug is not None:
        return find(slug)
    homes = [f for f in folders() if all(file.resolve().is_relative_to(f.resolve()) for file in files)]
    known, broken = found()
    if len(only := [slug_of(home) for home in homes] or [*known, *broken]) == 1:
        return find(only[0])
    words = {word for file in files for word in _words(file)}
    likely = [a for a in known.values() if a.functions() & words]
    if len(likely) == 1 and not broken:
        return likely[0]
    told = "".join(f"; {error}" for error in broken.values())
    raise NoAssignment(f"which assignment are they for? Say --assignment {' or '.join(sorted(known)) or '…'}{told}")


def _words(file: Path) -> set[str]:
    with file.open("rb") as stream:
        return set(re.findall(r"\w+", stream.read(MOST_BYTES).decode("utf-8", "replace")))
