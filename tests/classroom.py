"""For tests of a class: submissions with reports as a worker writes them, without grading."""

import time
import uuid

from ecp.judge import Verdict
from ecp.outcome import Diagnosis, Ending, Outcome, SceneEnding, Tolerance
from ecp.report import ExerciseReport, Provenance, Report
from exercises.assignment import assignments
from service.grading.submission import Submission
from service.store import runs
from service.store.accept import accept
from service.store.records import New

ASSIGNMENT = assignments()["rigid-body"]
SLIP = Diagnosis("sign-flipped", "ω̇₂ has the opposite sign: check (I₃ − I₁)", 1.0)
SLOW = SceneEnding("motion", Ending.TIMED_OUT, "your code did not finish within 2 s", "timeout")


def outcome(id, mark="✓", margin=10.0, diagnosis=None):
    """A check's outcome by its mark in a class's table."""
    verdict = {"✓": Verdict.PASS, "✗": Verdict.FAIL}.get(mark, Verdict.UNMEASURED)
    cause = {"⏱": SLOW.sentence, "!": "ValueError: no", "–": "your code stopped before this was played"}.get(mark)
    told = [] if mark == "✓" else [diagnosis or SLIP]
    label = next((c.label for c in ASSIGNMENT.checks() if c.id == id), id)
    tolerance = Tolerance(limit=1e-6, reason="test")
    given = {"margin": None if cause else margin, "cause": cause, "diagnosis": told, "tolerance": tolerance}
    return Outcome(id=id, label=label, verdict=verdict, detail="test", **given)


def report(marks, seed=7, **about):
    """A report of exercise 2 and others with those marks by check."""
    endings = [SLOW, SceneEnding("cell 1", Ending.RAISED, "ValueError: no", "raises", "Traceback …")]
    sections = [
        ExerciseReport(e.number, e.title, [outcome(c.id, *_told(marks[c.id])) for c in e.checks if c.id in marks])
        for e in ASSIGNMENT.exercises
    ]
    made = [s for s in sections if s.outcomes]
    provenance = Provenance(seed, {"polhode": "test"}, "tier A: test", phases_ms={"grade": 1000.0})
    return Report("rigid-body", about.pop("version", "1"), made, provenance, endings=endings, **about)


async def hand_in(
    database, person, marks, *, days_ago=0.0, source="def euler_eqs(t, w, I):\n    return w\n", filename="a.py", **about
):
    """A submission, graded if ``marks`` is not None; its id."""
    arrived = time.monotonic() - 86400.0 * days_ago
    new = New(uuid.uuid4(), "rigid-body", person, Submission(source, filename), ["2"], 7, arrived)
    await accept(database, new)
    if marks is not None:
        await grade(database, new.id, marks, **about)
    return new.id


async def grade(database, submission, marks, **about):
    """Give the last attempt of a submission its result."""
    query = "SELECT id FROM attempt WHERE submission_id = :id ORDER BY number DESC LIMIT 1"
    attempt = (await database.rows(query, {"id": submission}))[0].id
    claimed = await runs.claim(database, attempt, uuid.uuid4(), "test worker")
    assert await runs.finish(database, claimed, report(marks, **about), {"arrays.npz": b"none"})


def _told(told):
    return told if isinstance(told, tuple) else (told,)
