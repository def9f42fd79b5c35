"""The home page, a student's page of an assignment, and the audit log."""

import asyncio
from typing import Annotated

from fastapi import APIRouter, HTTPException, Query, Request
from fastapi.responses import HTMLResponse, RedirectResponse, Response
from starlette.routing import Match

from exercises.authoring.assignments.catalogue import assignments
from exercises.authoring.assignments.index import line_counts
from service.api.health import WorkerStatus
from service.api.kit import notebook_for
from service.api.past_submissions import list_own
from service.api.release import visible_row
from service.api.submissions import Available, Stored
from service.auth import forms
from service.auth.identity import STAFF
from service.auth.roles import CurrentUser, OptionalUser, Staff
from service.formats.grade_row import total_percent
from service.http.errors import Problem
from service.http.requests import PublicAddress
from service.http.state import Db, Held
from service.http.templating import templates
from service.pages import markdown
from service.pages.course import cards, task
from service.pages.course.audit_words import tell
from service.pages.rejected_forms import post_form
from service.store.course import course_settings, deadlines, gradebook
from service.store.course.audit import MOST, entries
from service.store.course.grades import grades
from service.store.submissions.records import recent

router, others = APIRouter(), APIRouter()
LATEST = 20


@router.get("/", response_class=HTMLResponse)
async def index(request: Request, person: CurrentUser, database: Db, workers: Held[WorkerStatus]) -> Response:
    """Show the assignments and the latest submissions: all of them to staff, their own to students."""
    staff = person.role in STAFF
    isolation, reason = await workers.current()
    order = list(assignments())
    overview = [
        row for row in await gradebook.overview(database) if row.slug in order and (staff or row.published)
    ]
    own_rows = [] if staff else await deadlines.of_person(database, person.name)
    mine = {row.slug: row for row in own_rows}
    counted = [] if staff else await grades(database, person=person.name)
    own = [one for one in counted if one.assignment in order and one.released]
    groups = cards.groups(overview, mine, order)
    context = {
        "staff": staff,
        "course": await course_settings.read(database),
        "own": {one.assignment: one for one in own},
        "total": total_percent(own, graded=True),
        "rows": [
            visible_row(person, row) for row in await recent(database, LATEST, None if staff else person.name)
        ],
        "assignments": assignments(),
        "lines": staff and any(map(line_counts, assignments().values())),
        "overview": overview,
        "groups": groups,
        "next": cards.next_deadline(groups, mine),
        "weights": sum(row.weight for row in overview if row.published),
        "medians": await gradebook.medians(database) if staff else {},
        "standings": mine,
        "isolation": isolation or reason or "no worker is running",
    }
    return templates.TemplateResponse(request, "index.html", context)


@router.get("/assignments/{slug}", response_class=HTMLResponse)
async def own_submissions(
    request: Request,
    person: CurrentUser,
    assignment: Available,
    database: Db,
    same: Annotated[str, Query(max_length=40)] = "",
) -> Response:
    """Show the person's submissions to an assignment and the changes between them.

    ``same`` is the id of the submission that an upload repeats: the page asks whether to submit it again.
    """
    history = await list_own(assignment, person, database)
    best, last = (
        next((s for s in history.submissions if s.id == id), None) for id in (history.best, history.last)
    )
    context = {"assignment": assignment, "person": person.name, "history": history}
    context["late_penalty"] = (await course_settings.read(database)).late_penalty
    context["same"] = next((s for s in history.submissions if str(s.id) == same), None)
    context |= {"best": best, "last": last, "most": assignment.most_points}
    context |= {"exercises": task.exercises(assignment, best), "limits": task.limits(assignment)}
    return templates.TemplateResponse(request, "submissions.html", context)


@router.get("/help", response_class=HTMLResponse)
async def show_help(request: Request, person: OptionalUser) -> Response:
    """Show how to log in, submit, read a report and ask for a regrade."""
    return templates.TemplateResponse(request, "help.html", {})


@router.get("/assignments/{slug}/notebook", response_class=HTMLResponse)
async def read_notebook(
    request: Request, person: CurrentUser, assignment: Available, server: PublicAddress
) -> Response:
    """Show the students' notebook to read."""
    cells = await asyncio.to_thread(lambda: markdown.cells(notebook_for(assignment, server)))
    context = {"assignment": assignment, "cells": cells}
    return templates.TemplateResponse(request, "notebook.html", context)


@post_form(router, "/assignments/{slug}/submissions", page=own_submissions, at="/assignments/{slug}")
async def upload(slug: str, person: CurrentUser, origin: forms.SameOrigin, stored: Stored) -> Response:
    """Store an uploaded file as a submission, and show its page; ask first if it repeats the person's last
    submission.
    """
    return RedirectResponse(
        f"/assignments/{slug}?same={stored.id}" if stored.repeated else f"/submissions/{stored.id}", 303
    )


@router.get("/audit", response_class=HTMLResponse)
async def audit_log(
    request: Request,
    person: Staff,
    database: Db,
    subject: Annotated[str, Query(max_length=200)] = "",
    before: Annotated[int | None, Query(ge=0, le=2**62)] = None,
) -> Response:
    """Show the latest entries in words, optionally of one person or subject."""
    subject = subject.strip().replace("\x00", "")
    rows = await entries(database, subject or None, before)
    older = rows[-1].id if len(rows) == MOST else None
    context = {"entries": [*map(tell, rows)], "subject": subject, "older": older}
    return templates.TemplateResponse(request, "audit.html", context)


@others.api_route("/{path:path}", methods=["GET", "POST", "PUT", "PATCH", "DELETE"])
async def not_found(request: Request, path: str, person: OptionalUser) -> Response:
    """Answer every address that nothing else answers with a page on which those who are logged in find their
    way back.
    """
    if any(route.matches(request.scope)[0] is Match.PARTIAL for route in request.app.routes):
        raise HTTPException(405)  # another route has this address, not this method
    raise Problem(404, "not-found", "nothing has this address: check it")
