"""Grading again, with a look first: begin a regrade, see what it would change, then apply or drop it."""

import weakref
from collections import Counter, defaultdict
from collections.abc import AsyncIterator, Iterable, Mapping, Sequence
from typing import Annotated, Any
from uuid import UUID

from fastapi import APIRouter, Depends, Header, Request
from fastapi.responses import HTMLResponse, RedirectResponse, Response
from fastapi.sse import EventSourceResponse, ServerSentEvent
from sqlalchemy import Row

from exercises.assignment import Assignment
from service.api.submissions import find_assignment
from service.auth.forms import Form, field
from service.auth.roles import Instructor, Staff
from service.grading.result import MARKS, WORDS
from service.http.errors import Problem
from service.http.live import ChangeFeed
from service.http.templating import templates
from service.pages.queue import identifier
from service.store import records, regrades
from service.store.regrades import BEST, EVERY, Regrade

router = APIRouter()
_watched: weakref.WeakValueDictionary[UUID, ChangeFeed[Any]] = weakref.WeakValueDictionary()  # while somebody looks


async def _find(request: Request, id: str) -> Regrade:
    found = await regrades.find(request.app.state.database, identifier(id))
    if found is None:
        raise Problem(404, "not-found", "there is no such regrade")
    return found


Found = Annotated[Regrade, Depends(_find)]


@router.get("/assignments/{slug}/regrades", response_class=HTMLResponse)
async def all_of(slug: str, request: Request, person: Staff) -> Response:
    """The regrades of an assignment, and a form to begin one."""
    assignment = find_assignment(slug)
    context = {"assignment": assignment, "labels": labels_of(assignment)}
    context["regrades"] = await regrades.of_assignment(request.app.state.database, slug)
    return templates.TemplateResponse(request, "regrades.html", context)


@router.post("/assignments/{slug}/regrades")
async def begin(slug: str, request: Request, person: Staff, form: Form) -> Response:
    """Begin a regrade of what the form names; nothing shown changes."""
    which, check, told = await _meant(request, find_assignment(slug), field(form, "which"), field(form, "check"))
    try:
        id = await regrades.create(request.app.state.database, slug, which, person.name, check=check, description=told)
    except regrades.NothingToGrade:
        raise Problem(409, "not-ready", f"nothing to grade again ({told}): there is none, or it is being graded") from None
    request.app.state.queue.changed()
    return RedirectResponse(f"/regrades/{id}", 303)


@router.get("/regrades/{id}", response_class=HTMLResponse)
async def page(request: Request, person: Staff, regrade: Found) -> Response:
    """How far it is, and what it changes."""
    database = request.app.state.database
    pairs, flips = await regrades.score_changes(database, regrade.id), await regrades.check_changes(database, regrade.id)
    assignment = find_assignment(regrade.assignment)
    context: dict[str, Any] = {"regrade": regrade, "assignment": assignment, "diff": diff(pairs, flips, labels_of(assignment))}
    role = request.state.role
    context["may_drop"] = regrade.decided is None and (role == "instructor" or person.name == regrade.requested_by)
    context["may_apply"] = regrade.decided is None and role == "instructor" and regrade.finished == regrade.total
    return templates.TemplateResponse(request, "regrade.html", context)


@router.get("/regrades/{id}/events", response_class=EventSourceResponse)
async def events(
    request: Request, person: Staff, regrade: Found, last_event_id: Annotated[str | None, Header()] = None
) -> AsyncIterator[ServerSentEvent]:
    """An event whenever more is finished or it is decided, at most one per second."""
    async for event in _watch(request, regrade.id).events(last_event_id):
        yield event


@router.post("/regrades/{id}/apply")
async def apply(request: Request, person: Instructor, form: Form, regrade: Found) -> Response:
    """Let the new results count."""
    try:
        await regrades.apply(request.app.state.database, regrade.id, person.name)
    except regrades.RegradeIncomplete as why:
        raise Problem(409, "not-ready", f"this cannot be applied yet: {why}") from None
    except regrades.RegradeClosed as why:
        raise Problem(409, "changed-meanwhile", str(why)) from None
    return RedirectResponse(f"/regrades/{regrade.id}", 303)


@router.post("/regrades/{id}/drop")
async def drop(request: Request, person: Staff, form: Form, regrade: Found) -> Response:
    """Leave everything as it was."""
    if request.state.role != "instructor" and person.name != regrade.requested_by:
        raise Problem(403, "not-allowed", "only instructors and who asked for a regrade may drop it")
    try:
        await regrades.drop(request.app.state.database, regrade.id, person.name)
    except regrades.RegradeClosed as why:
        raise Problem(409, "changed-meanwhile", str(why)) from None
    request.app.state.queue.changed()
    return RedirectResponse(f"/regrades/{regrade.id}", 303)


async def _meant(request: Request, assignment: Assignment, which: str, check: str) -> tuple[UUID | str, str | None, str]:
    """What the form's words mean: which submissions, of which check the victims, and both in words for people."""
    if which == "check":
        if check not in labels_of(assignment):
            raise Problem(422, "invalid-request", f"the assignment has no check {check[:80]}", "/check")
        return BEST, check, f"best submissions without ✓ at {check}"
    if which in (BEST, EVERY):
        return which, None, "everybody's best submission" if which == BEST else "every submission of everybody"
    if not which:
        raise Problem(422, "invalid-request", "tell which submissions: all, every, check or the id of one", "/which")
    stored = await records.read(request.app.state.database, identifier(which))
    if stored is None or stored.assignment != assignment.slug:
        raise Problem(404, "not-found", f"{assignment.slug} has no submission {which[:80]}")
    return stored.id, None, f"one submission of {stored.person}"


def _watch(request: Request, id: UUID) -> ChangeFeed[Regrade | None]:
    """One for all who look at that regrade on this server."""
    state, watch = request.app.state, _watched.get(id)
    if watch is None:
        watch = _watched[id] = ChangeFeed(state.listener, lambda: regrades.find(state.database, id), lambda regrade: regrade)
    return watch


GROUPS = ("gains", "loses", "unchanged", "faults", "overtaken")
MOST_FLIPPED = 12


def diff(pairs: Sequence[Row[Any]], flips: Iterable[Row[Any]], labels: Mapping[str, str]) -> dict[str, Any]:
    """Finished ones by group, with points and flips; the checks that flip most; the versions compared."""
    by_grading: dict[UUID, list[dict[str, str]]] = defaultdict(list)
    kinds: Counter[tuple[str, str]] = Counter()
    for flip in flips:
        told = f"{_mark(flip.was)} → {_mark(flip.now)}"
        named = {"check": flip.check_id, "label": labels.get(flip.check_id, "")}
        by_grading[flip.grading].append(named | {"told": told, "words": f"{_word(flip.was)}, now {_word(flip.now)}"})
        kinds[flip.check_id, told] += 1
    groups: dict[str, list[dict[str, Any]]] = {name: [] for name in GROUPS}
    for row in pairs:
        if row.finished:
            groups[_group(row)].append(row._asdict() | {"flips": by_grading[row.grading]})
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
