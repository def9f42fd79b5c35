"""A student's submissions to an assignment, as JSON for ``polhode.submissions()`` and for the page."""

import asyncio
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, replace
from itertools import zip_longest

from fastapi import APIRouter

from polhode.judging.verdict import MARKS, Verdict
from service.api import response_models
from service.api.submissions import Available
from service.auth.identity import STAFF, Person, Reader
from service.http.openapi import PERSON, problems
from service.http.state import Db
from service.store.course import deadlines
from service.store.submissions.past_submissions import PastSubmission, past_submissions

router = APIRouter(tags=["Submissions"])


@router.get(
    "/v1/assignments/{slug}/submissions",
    responses=problems(
        PERSON
        | {
            403: ("not-allowed", "not-available"),
            404: "not-found",
            503: ("assignment-broken", "busy"),
        }
    ),
)
async def list_own(assignment: Available, person: Reader, database: Db) -> response_models.History:
    """Return the person's submissions, newest first, with verdicts and changes since the previous one,
    the best and last ids, and the person's own deadline and number of submissions.
    """
    found = [_released(person, one) for one in await past_submissions(database, person.name, assignment.slug)]
    graded = [one for one in found if one.points is not None]
    best = max(graded, key=lambda one: one.final or 0, default=None)  # the newest of equals
    return response_models.History(
        assignment=assignment.slug,
        max_points=assignment.max_points(),
        bonus_points=assignment.bonus_points(),
        submissions=await asyncio.to_thread(_answers, found),
        best=best and best.id,
        last=found[0].id if found else None,
        **(await deadlines.own(database, assignment.slug, person.name))._asdict(),
    )


def _released(person: Person, one: PastSubmission) -> PastSubmission:
    """Return the submission without scores and verdicts if the person may not see them yet."""
    if one.scores_released or person.role in STAFF:
        return one
    return replace(one, score=None, max_score=None, total=None, points=None, penalty=0, verdicts={})


def _answers(found: Sequence[PastSubmission]) -> list[response_models.Past]:
    return [
        response_models.Past(
            **asdict(one), final=one.final, changed=None if earlier is None else _changed(earlier, one)
        )
        for one, earlier in zip_longest(found, found[1:])
    ]


def _changed(earlier: PastSubmission, later: PastSubmission) -> response_models.Changed:
    common = sorted(earlier.verdicts.keys() & later.verdicts.keys())
    changed = {
        id: [earlier.verdicts[id], later.verdicts[id]]
        for id in common
        if earlier.verdicts[id] != later.verdicts[id]
    }
    kinds = Counter(" → ".join(MARKS[Verdict(verdict)] for verdict in pair) for pair in changed.values())
    added = Counter(
        f"new {MARKS[Verdict(later.verdicts[id])]}"
        for id in sorted(later.verdicts.keys() - earlier.verdicts.keys())
    )
    counts = [
        f"{count} check{'s' if count > 1 else ''} {kind}" for kind, count in [*kinds.items(), *added.items()]
    ]
    summary = "; ".join([_difference(earlier, later), *counts])
    return response_models.Changed(checks=changed, summary=summary)


def _difference(earlier: PastSubmission, later: PastSubmission) -> str:
    if earlier.sha256 == later.sha256:
        return "same source"
    was, now = Counter(earlier.source.splitlines()), Counter(later.source.splitlines())
    return f"lines +{(now - was).total()} −{(was - now).total()}"
