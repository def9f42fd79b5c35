"""A synthetic class for the demonstration: forty students who submit samples, graded after all interactive
submissions.
"""

import time
import uuid
from collections.abc import Iterator, Sequence
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import numpy as np

from exercises.authoring.assignments.assignment import Assignment
from exercises.authoring.assignments.catalogue import assignments
from exercises.authoring.assignments.samples import samples
from service.cli.server.database import database_url, run_async
from service.grading.submission import Submission
from service.settings import Settings
from service.store.course import assignment_settings, deadlines
from service.store.database import Database
from service.store.people import people, tokens
from service.store.submissions.accepting import accept, register
from service.store.submissions.records import NewSubmission

GIVEN = [
    "Ada", "Amir", "Beatriz", "Chen", "Dana", "Emil", "Farah", "Goran", "Hana", "Igor", "Jun", "Kofi", "Lena",
    "Mateo", "Nia", "Omar", "Petra", "Quinn", "Rosa", "Samir",
]  # fmt: skip
FAMILY = [
    "Adeyemi", "Brandt", "Castillo", "Dimitrov", "Eriksen", "Fischer", "Gupta", "Haddad", "Ito", "Jansen",
    "Kowalski", "Lindqvist", "Moreau", "Novak",
]  # fmt: skip
STUDENTS, BY, INSTRUCTOR = 40, "demo", "instructor"
_BUSIEST = """
SELECT p.name, p.full_name FROM person p LEFT JOIN submission s ON s.person_id = p.id
WHERE starts_with(p.name, 'student-') GROUP BY p.id ORDER BY count(s.id) DESC, p.name LIMIT 1
"""
# The samples submitted and their relative frequencies: first tries, then final submissions.
TRIES = {
    "wrong_sign_flipped.py": 7,
    "wrong_missing_division_all.py": 4,
    "wrong_cyclic_order.py": 3,
    "wrong_syntax.py": 3,
    "wrong_raises.py": 2,
    "wrong_zeros.py": 2,
    "hostile_endless.py": 2,
    "wrong_returns_none.py": 2,
    "wrong_time_reversed.py": 1,
}
ENDS = {
    "right_all.py": 9,
    "right_notebook.ipynb": 4,
    "right_roll.py": 5,
    "right_cross.py": 3,
    "right_terms.py": 3,
    "wrong_sign_flipped.py": 3,
    "wrong_animation_static.py": 2,
    "wrong_ex1_half_edges.py": 2,
    "wrong_ex4_no_unwrap.py": 2,
}


def add_class(settings: Settings, slugs: Sequence[str]) -> int:
    """Add the class and its submissions to these assignments to the running server's database unless it has
    them.

    Return the number of submissions added.
    """
    with database_url(settings) as url:
        return run_async(url, lambda database: _add_class(database, [assignments()[slug] for slug in slugs]))


def logins(settings: Settings) -> dict[str, str]:
    """Return new tokens by whose they are: an instructor's, and that of the student with most submissions."""
    with database_url(settings) as url:
        return run_async(url, _logins)


async def _logins(database: Database) -> dict[str, str]:
    busiest = await database.one(_BUSIEST)
    found = {}
    async with database.begin() as connection:
        await people.enroll(connection, [(INSTRUCTOR, "instructor", "Iris Weber")])
        for role, name in (
            ("the instructor", INSTRUCTOR),
            (f"the student {busiest.full_name}", busiest.name),
        ):
            found[role] = await tokens.create(
                connection, name, label="demonstration", scopes=tokens.SCOPES, seconds=tokens.DAY_S
            )
    return found


async def _add_class(database: Database, chosen: Sequence[Assignment]) -> int:
    rng = np.random.default_rng(26)
    await register(database, assignments().values())
    if any(row.name.startswith("student-") for row in await people.everybody(database)):
        return 0
    names = [f"{rng.choice(GIVEN)} {rng.choice(FAMILY)}" for _ in range(STUDENTS)]
    ids = [f"student-{k:02}" for k in range(1, STUDENTS + 1)]
    roster = [
        (id, "student", name, f"{id}@example.org", f"{260000 + k}")
        for k, (id, name) in enumerate(zip(ids, names, strict=True), 1)
    ]
    async with database.begin() as connection:
        await people.enroll(connection, [("local", "instructor"), *roster])
    due = datetime.now(UTC).replace(minute=0, second=0, microsecond=0) + timedelta(days=2)
    for week, assignment in enumerate(chosen):
        settings = {
            "published": True,
            "due_at": due + timedelta(weeks=week),
            "grace_s": 3600.0,
            "weight": 1.0 + (week == 0),
        }
        await assignment_settings.change(database, assignment.slug, settings, BY)
    late = due + timedelta(days=3)
    await deadlines.extend(
        database, chosen[0].slug, roster[4][0], late, reason="was ill for three days", by=BY
    )
    submissions = [new for name, *_ in roster for new in _submissions(chosen[0], name, rng)]
    submissions += [new for one in chosen[1:] for name, *_ in roster[::3] for new in _made(one, name, rng)]
    for new in sorted(submissions, key=lambda new: new.arrived):
        await accept(database, new, kind="bulk")
    return len(submissions)


def _submissions(assignment: Assignment, name: str, rng: np.random.Generator) -> Iterator[NewSubmission]:
    """Yield the student's up to three submissions of the last days; the last one is usually the best."""
    files = {s.file.name: s for s in samples(assignment)}
    tries, ends = (
        _draw_names(table, count, rng)
        for table, count in ((TRIES, int(rng.choice([0, 1, 1, 2]))), (ENDS, int(rng.random() < 0.85)))
    )
    ago = rng.uniform(0.5, 4.0)
    for file in [*tries, *ends]:
        sample, ago = files[file], ago * 0.8
        submission = Submission.from_bytes(sample.file.read_bytes(), f"{name}{sample.file.suffix}")
        submission = replace(submission, exercises=sample.ask)
        arrived = time.monotonic() - 86400.0 * ago
        seed = int(rng.integers(2**48))
        yield NewSubmission(uuid.uuid4(), assignment.slug, name, submission, seed, arrived)


def _made(assignment: Assignment, name: str, rng: np.random.Generator) -> Iterator[NewSubmission]:
    """Yield a wrong submission to an assignment whose samples follow from its declaration, and mostly a right
    one after it.
    """
    right, *others = [sample for sample in assignment.made_samples() if not sample.is_notebook]
    wrong, arrived = others[rng.integers(len(others))], time.monotonic() - 86400.0 * rng.uniform(0.1, 2.0)
    for k, sample in enumerate([wrong, right] if rng.random() < 0.6 else [wrong]):
        submission = Submission.from_bytes(sample.source.encode(), f"{name}.py")
        seed = int(rng.integers(2**48))
        yield NewSubmission(uuid.uuid4(), assignment.slug, name, submission, seed, arrived + 3600.0 * k)


def _draw_names(table: dict[str, int], count: int, rng: np.random.Generator) -> list[str]:
    weights = np.array(list(table.values()), float)
    return [str(name) for name in rng.choice(list(table), count, p=weights / weights.sum())]
