"""What a regrade changes, as its page tells it: who gains, who loses, which checks are another than before."""

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from typing import Any
from uuid import UUID

from sqlalchemy import Row

from exercises.assignment import Assignment
from service.grading.states import MARKS, WORDS

GROUPS = ("gains", "loses", "unchanged", "faults", "overtaken")
MOST_FLIPPED = 12


def diff(pairs: Sequence[Row[Any]], flips: Iterable[Row[Any]], labels: Mapping[str, str]) -> dict[str, Any]:
    """Finished ones by group, with points and flips; the checks that flip most; the versions compared."""
    by_attempt: dict[UUID, list[dict[str, str]]] = defaultdict(list)
    kinds: Counter[tuple[str, str]] = Counter()
    for flip in flips:
        told = f"{_mark(flip.was)} → {_mark(flip.now)}"
        named = {"check": flip.check_id, "label": labels.get(flip.check_id, "")}
        by_attempt[flip.attempt].append(named | {"told": told, "words": f"{_word(flip.was)}, now {_word(flip.now)}"})
        kinds[flip.check_id, told] += 1
    groups: dict[str, list[dict[str, Any]]] = {name: [] for name in GROUPS}
    for row in pairs:
        if row.finished:
            groups[_group(row)].append(row._asdict() | {"flips": by_attempt[row.attempt]})
    flipped = [
        {"check": check, "label": labels.get(check, ""), "told": told, "count": count}
        for (check, told), count in kinds.most_common(MOST_FLIPPED)
    ]
    versions = {side: sorted({v for row in pairs if (v := getattr(row, side))}) for side in ("was_version", "version")}
    return {"groups": groups, "flipped": flipped, "from": versions["was_version"], "to": versions["version"]}


def labels_of(assignment: Assignment) -> dict[str, str]:
    """By its id, the label of every check, with the exercise."""
    return {c.id: f"{e.number}: {c.label}" for e in assignment.exercises for c in e.checks}


def _group(row: Row[Any]) -> str:
    if row.fault is not None:
        return "faults"
    if row.overtaken:
        return "overtaken"
    if row.was_points == row.points:
        return "unchanged"
    return "gains" if row.was_points is None or row.points > row.was_points else "loses"


def _mark(state: str | None) -> str:
    return MARKS.get(state or "", "(none)")


def _word(state: str | None) -> str:
    return WORDS.get(state or "", "not there")
