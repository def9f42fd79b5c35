"""A student's submissions to an assignment, as JSON for ``ecp.submissions()`` and for the page."""

import asyncio
from collections import Counter
from collections.abc import Sequence
from itertools import zip_longest
from typing import Any

from fastapi import APIRouter

from ecp.judge import MARKS, Verdict
from service.api.submissions import Assigned
from service.auth.identity import Reader
from service.http.openapi import PERSON, problems
from service.http.state import Db
from service.store.history import PastSubmission, past_submissions

router = APIRouter()


@router.get(
    "/v1/assignments/{slug}/submissions", responses=problems(PERSON | {404: "not-found", 503: ("assignment-broken", "busy")})
)
async def list_own(assignment: Assigned, person: Reader, database: Db) -> dict[str, Any]:
    """Return the person's submissions, newest first, with verdicts and changes since the previous one,
    and the best and last ids.
    """
    found = await past_submissions(database, person.name, assignment.slug)
    listed = await asyncio.to_thread(_to_json, found)
    graded = [one for one in listed if one["points"] is not None]
    best = max(graded, key=lambda one: one["points"], default=None)  # the newest of equals
    last = listed[0]["id"] if listed else None
    return {"assignment": assignment.slug, "submissions": listed, "best": best and best["id"], "last": last}


def _to_json(found: Sequence[PastSubmission]) -> list[dict[str, Any]]:
    return [
        {
            "id": str(one.id),
            "submitted_at": one.submitted_at.isoformat(),
            "late": one.late,
            "filename": one.filename,
            "status": one.status,
            "score": one.score,
            "max_score": one.max_score,
            "total": one.total,
            "points": one.points,
            "sha256": one.sha256,
            "verdicts": one.verdicts,
            "changed": None if earlier is None else _changed(earlier, one),
        }
        for one, earlier in zip_longest(found, found[1:])
    ]


def _changed(earlier: PastSubmission, later: PastSubmission) -> dict[str, Any]:
    """Return the checks whose verdict changed, each with both verdicts, and a summary in words.

    API v1 calls the summary ``told``; ``summary`` is the same text.
    """
    common = sorted(earlier.verdicts.keys() & later.verdicts.keys())
    changed = {id: [earlier.verdicts[id], later.verdicts[id]] for id in common if earlier.verdicts[id] != later.verdicts[id]}
    kinds = Counter(" → ".join(MARKS[Verdict(verdict)] for verdict in pair) for pair in changed.values())
    counts = [f"{count} check{'s' if count > 1 else ''} {kind}" for kind, count in kinds.items()]
    summary = "; ".join([_difference(earlier, later), *counts])
    return {"checks": changed, "summary": summary, "told": summary}


def _difference(earlier: PastSubmission, later: PastSubmission) -> str:
    if earlier.sha256 == later.sha256:
        return "same source"
    was, now = Counter(earlier.source.splitlines()), Counter(later.source.splitlines())
    return f"lines +{(now - was).total()} −{(was - now).total()}"
