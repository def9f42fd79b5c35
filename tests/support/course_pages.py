"""For tests of every page: a course in which there is something on each of them, with texts of one's choice
in every field.
"""

import uuid
from datetime import UTC, datetime, timedelta
from urllib.parse import quote

from service.grading.submission import Submission
from service.store.course import (
    assignment_settings,
    audit,
    comments,
    deadlines,
    overrides,
    regrade_requests,
    regrades,
)
from service.store.people import people
from service.store.queue import cancelling as gradings
from service.store.queue import runs, workers
from service.store.submissions.accepting import accept
from service.store.submissions.records import NewSubmission
from tests.support import submissions
from tests.support.database import run, sql
from tests.support.reports import ASSIGNMENT
from tests.support.submissions import hand_in

BASE = "/assignments/rigid-body"
PLAIN = {"name": "ann", "full_name": "Ann Ångström", "filename": "ann.py", "words": "was ill for a week"}
SOURCE = """def euler_eqs(t, w, I):
    print("called at", t)
    return -np.cross(I * w, w) / I


def precession_rate(t, w):
    raise ValueError("not yet")
"""
_LATEST = "SELECT id FROM grading WHERE submission_id = %(id)s ORDER BY number DESC LIMIT 1"


def fill(url, sandbox, source=SOURCE, **texts):
    """Fill that database; the addresses of pages by what they show. ``texts`` are those of PLAIN."""
    return run(url, lambda database: _fill(database, url, sandbox, source, {**PLAIN, **texts}))


async def _fill(database, url, sandbox, source, texts):
    name, words = texts["name"], texts["words"]
    staff = [("prof", "instructor"), ("tutor", "assistant"), ("ben", "student", texts["full_name"])]
    async with database.begin() as connection:
        await people.enroll(
            connection, [*staff, (name, "student", texts["full_name"], "ann@example.org", "0042")]
        )
        await audit.record(connection, "prof", "roster", words, {"people": 4, words: words})
    first = await hand_in(database, name, {"2-energy": "✓", "2-momentum": ("✓", 1.5)}, days_ago=2.0)
    real = await _played(database, name, source, texts["filename"], sandbox)
    bad = await hand_in(
        database,
        "ben",
        {"2-energy": ("✗", 1e-3), "2-momentum": "⏱", "2-motion": "!"},
        filename=texts["filename"],
    )
    later = datetime.now(UTC) + timedelta(days=20)
    rules = {"due_at": later, "grace_s": 3600.0, "submission_limit": 20}
    await assignment_settings.change(database, ASSIGNMENT.slug, rules, "prof")
    await deadlines.extend(
        database, ASSIGNMENT.slug, name, later + timedelta(days=7), reason=words, by="prof"
    )
    await overrides.give(database, first, "prof", check="2-energy", points=0, reason=words, seen=0)
    await overrides.give(database, bad, "prof", check=None, points=3, reason=words, seen=0)
    answered = await regrade_requests.request(database, bad, "ben", words)
    await regrade_requests.answer(database, answered.id, "tutor", "declined", words)
    await regrade_requests.request(database, real, name, words)
    await comments.write(database, real, "tutor", cell=1, line=2, comment=words)
    decided = await regrades.create(database, ASSIGNMENT.slug, bad, "tutor", description=words)
    await submissions.grade(database, bad, {"2-energy": "✓", "2-momentum": ("✗", 0.1)}, version="2")
    regrade = await regrades.create(database, ASSIGNMENT.slug, first, "prof", description="one submission")
    await submissions.grade(database, first, {"2-energy": ("✗", 0.1), "2-momentum": "✓"}, version="2")
    await regrades.apply(database, decided, "prof")
    going = await _queue(database, url, name)
    paths = {
        "course": "/",
        "people": "/people",
        "class": f"{BASE}/class",
        "account": "/account",
        "login": "/login",
        "help": "/help",
        "notebook": f"{BASE}/notebook",
    }
    paths |= {tab: f"{BASE}/class/{tab}" for tab in ("students", "checks", "settings", "submissions")}
    paths |= {
        "chosen": f"{BASE}/class/submissions?check=2-momentum&state=not-pass",
        "queue": "/queue",
        "audit": "/audit",
    }
    paths |= {
        "passed": f"/submissions/{first}",
        "failed": f"/submissions/{real}",
        "given": f"/submissions/{bad}",
    }
    paths |= {
        "changed": f"/submissions/{real}/diff",
        "regrades": f"{BASE}/regrades",
        "requests": f"{BASE}/regrade-requests",
        "regrade": f"/regrades/{regrade}",
    }
    paths |= {
        "waiting": f"/submissions/{going}",
        "applied": f"/regrades/{decided}",
        "attempts": BASE,
        "reference": "/reference",
    }
    paths |= {
        "person": f"/person?name={quote(name)}",
        "search": "/search?q=a",
        "course settings": "/settings",
        "setup": "/setup",
        "lines": "/lines",
        "start": "/start",
        "add person": "/people/add",
        "extensions": "/extensions",
        "api": "/docs",
    }
    return paths | {
        "problem": "/submissions/none",
        "nobody": f"{BASE}/class/submissions?check=2-energy&state=timeout",
    }


async def _played(database, name, source, filename, sandbox):
    """A submission that was run in a sandbox, with figures, motions and whatever its code says."""
    new = NewSubmission(uuid.uuid4(), ASSIGNMENT.slug, name, Submission(source, filename, ["2", "4"]), 7)
    await accept(database, new)
    await submissions.grade_really(database, new.id, sandbox, {"grade": 1000.0, "pack": 10.0})
    return new.id


async def _queue(database, url, name):
    """One runs for ever, one waits, one was cancelled, one is a fault of ours; the one that waits."""
    ids = [await hand_in(database, who, None) for who in (name, "ben", name, "ben")]
    grading_ids = [(await database.rows(_LATEST, {"id": id}))[0].id for id in ids]
    await gradings.cancel(database, grading_ids[0], "tutor")
    claimed = [await runs.claim(database, grading_ids[k], uuid.uuid4(), "test worker") for k in (1, 2)]
    await runs.heartbeat(database, claimed[0], "playing", 2, 5)
    ended = "INSERT INTO result (grading_id, run_id, fault) VALUES (%s, %s, %s)"
    sql(url, ended, grading_ids[2], claimed[1].run, f"the worker of {name} was lost")
    sql(url, "UPDATE run SET ended_at = now(), end_reason = 'failed' WHERE id = %s", claimed[1].run)
    sql(
        url,
        "UPDATE run SET scene_at = now() - interval '8 s', heartbeat_at = now() + interval '1 h' WHERE id"
        " = %s",
        claimed[0].run,
    )
    sql(
        url,
        "DELETE FROM procrastinate_jobs WHERE args->>'attempt' = ANY(%s)",
        [str(grading_ids[k]) for k in (0, 1, 2)],
    )
    for worker, refusal in (("test worker", None), ("another worker", "no user namespaces")):
        await workers.register_worker(
            database, worker, None if refusal else "namespaces: bubblewrap", refusal
        )
    sql(url, "UPDATE worker SET seen_at = now() + interval '1 h'")
    return ids[3]
