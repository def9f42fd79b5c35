"""What the play of a scene says besides its arrays: remarks, and why an array is absent."""

from collections.abc import Collection, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import NamedTuple

MOST_REMARKS = 5  # of a scene


class Absent(NamedTuple):
    """Why an array holds no numbers of the submission: a sentence, and the diagnosis code if one fits."""

    sentence: str
    code: str | None


@dataclass
class Notes:
    """The ``remarks`` of one scene, and by array why it is ``absent``; such an array is filled with NaN."""

    remarks: list[str] = field(default_factory=list)
    absent: dict[str, Absent] = field(default_factory=dict)

    def unread(self, names: Collection[str] | None) -> Absent | None:
        """Return why one of the arrays ``names`` (None: of all) is absent, None if none is."""
        return next((why for name, why in self.absent.items() if names is None or name in names), None)


_kept = list[Notes]()


@contextmanager
def noting() -> Iterator[Notes]:
    """Keep the notes made in the ``with`` block."""
    _kept.append(notes := Notes())
    try:
        yield notes
    finally:
        _kept.pop()


def remark(sentence: str) -> None:
    """Note a remark, once."""
    for notes in _kept[-1:]:
        if sentence not in notes.remarks and len(notes.remarks) < MOST_REMARKS:
            notes.remarks.append(sentence)


def absent(name: str, why: Absent) -> bool:
    """Note why an array is absent, unless that is known. Return whether notes are kept."""
    for notes in _kept[-1:]:
        notes.absent.setdefault(name, why)
    return bool(_kept)


def unsaid(notes: Iterable[Notes], said: set[str]) -> list[str]:
    """Return the remarks that are not among those ``said``, and add them to these."""
    found = [one for each in notes for one in each.remarks if one not in said]
    said.update(found)
    return list(dict.fromkeys(found))
