"""What a student has sent so far: as JSON for ``ecp.attempts()``, and as a page."""

import asyncio
from collections import Counter
from collections.abc import Sequence
from itertools import zip_longest
from typing import Any

from fastapi import APIRouter, Request

from ecp.judge import MARKS, Verdict
from service.api.submissions import find_assignment
from service.auth.identity import authenticate
from service.store.history import PastSubmission, past_submissions

router = APIRouter()


@router.get("/v1/assignments/{slug}/submissions")
async def list_own(slug: str, request: Request) -> dict[str, Any]:
    """Your own submissions, newest first, each with its verdicts and what changed since the one before; the best and the last."""
    find_assignment(slug)
    person = await authenticate(request)
    found = await past_submissions(request.app.state.database, person.name, slug)
    told = await asyncio.to_thread(_told, found)
    graded = [one for one in told if one["points"] is not None]
    best = max(graded, key=lambda one: one["points"], default=None)  # of equals the newest
    return {"assignment": slug, "submissions": told, "best": best and best["id"], "last": told[0]["id"] if told else None}


def _told(found: Sequence[PastSubmission]) -> list[dict[str, Any]]:
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
    """Checks whose verdict is another than before, with both; and the same with how the source differs, in words."""
    both = sorted(earlier.verdicts.keys() & later.verdicts.keys())
    flips = {id: [earlier.verdicts[id], later.verdicts[id]] for id in both if earlier.verdicts[id] != later.verdicts[id]}
    kinds = Counter(" → ".join(MARKS[Verdict(verdict)] for verdict in pair) for pair in flips.values())
    told = [f"{count} check{'s' if count > 1 else ''} {kind}" for kind, count in kinds.items()]
    return {"checks": flips, "told": "; ".join([_difference(earlier, later), *told])}


def _difference(earlier: PastSubmission, later: PastSubmission) -> str:
    if earlier.sha256 == later.sha256:
        return "the same source"
    was, now = Counter(earlier.source.splitlines()), Counter(later.source.splitlines())
    return f"lines +{(now - was).total()} −{(was - now).total()}"
