"""Grading again, with a look first: begin a regrade, see what it would change, then apply or drop it."""

import weakref
from collections.abc import AsyncIterator
from typing import Annotated, Any
from uuid import UUID

from fastapi import APIRouter, Depends, Header, Request
from fastapi.responses import HTMLResponse, RedirectResponse, Response
from fastapi.sse import EventSourceResponse, ServerSentEvent

from exercises.assignment import Assignment
from service.store import preview, reading, regrading
from service.store.regrading import BEST, EVERY, Regrade
from service.web.forms import Form, field
from service.web.problems import Problem
from service.web.queue import identifier
from service.web.regraded import diff, labels_of
from service.web.roles import Instructor, Staff
from service.web.routes import find_assignment
from service.web.templating import templates
from service.web.watching import Watch

router = APIRouter()
_watched: weakref.WeakValueDictionary[UUID, Watch[Any]] = weakref.WeakValueDictionary()  # while somebody looks


async def _find(request: Request, id: str) -> Regrade:
    found = await regrading.find(request.app.state.database, identifier(id))
    if found is None:
        raise Problem(404, "not-found", "there is no such regrade")
    return found


Found = Annotated[Regrade, Depends(_find)]


@router.get("/assignments/{slug}/regrades", response_class=HTMLResponse)
async def all_of(slug: str, request: Request, person: Staff) -> Response:
    """The regrades of an assignment, and a form to begin one."""
    assignment = find_assignment(slug)
    context = {"assignment": assignment, "labels": labels_of(assignment)}
    context["regrades"] = await regrading.of_assignment(request.app.state.database, slug)
    return templates.TemplateResponse(request, "regrades.html", context)


@router.post("/assignments/{slug}/regrades")
async def begin(slug: str, request: Request, person: Staff, form: Form) -> Response:
    """Begin a regrade of what the form names; nothing shown changes."""
    which, check, told = await _meant(request, find_assignment(slug), field(form, "which"), field(form, "check"))
    try:
        id = await regrading.begin(request.app.state.database, slug, which, person.name, check=check, told=told)
    except regrading.NothingToGrade:
        raise Problem(409, "not-ready", f"nothing to grade again ({told}): there is none, or it is being graded") from None
    request.app.state.queue.changed()
    return RedirectResponse(f"/regrades/{id}", 303)


@router.get("/regrades/{id}", response_class=HTMLResponse)
async def page(request: Request, person: Staff, regrade: Found) -> Response:
    """How far it is, and what it changes."""
    database = request.app.state.database
    pairs, flips = await preview.pairs(database, regrade.id), await preview.flips(database, regrade.id)
    assignment = find_assignment(regrade.assignment)
    context: dict[str, Any] = {"regrade": regrade, "assignment": assignment, "diff": diff(pairs, flips, labels_of(assignment))}
    role = request.state.role
    context["may_drop"] = regrade.decided is None and (role == "instructor" or person.name == regrade.asked_by)
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
        await regrading.apply(request.app.state.database, regrade.id, person.name)
    except regrading.Unfinished as why:
        raise Problem(409, "not-ready", f"this cannot be applied yet: {why}") from None
    except regrading.Decided as why:
        raise Problem(409, "changed-meanwhile", str(why)) from None
    return RedirectResponse(f"/regrades/{regrade.id}", 303)


@router.post("/regrades/{id}/drop")
async def drop(request: Request, person: Staff, form: Form, regrade: Found) -> Response:
    """Leave everything as it was."""
    if request.state.role != "instructor" and person.name != regrade.asked_by:
        raise Problem(403, "not-allowed", "only instructors and who asked for a regrade may drop it")
    try:
        await regrading.drop(request.app.state.database, regrade.id, person.name)
    except regrading.Decided as why:
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
    stored = await reading.read(request.app.state.database, identifier(which))
    if stored is None or stored.assignment != assignment.slug:
        raise Problem(404, "not-found", f"{assignment.slug} has no submission {which[:80]}")
    return stored.id, None, f"one submission of {stored.person}"


def _watch(request: Request, id: UUID) -> Watch[Regrade | None]:
    """One for all who look at that regrade on this server."""
    state, watch = request.app.state, _watched.get(id)
    if watch is None:
        watch = _watched[id] = Watch(state.listener, lambda: regrading.find(state.database, id), lambda regrade: regrade)
    return watch
