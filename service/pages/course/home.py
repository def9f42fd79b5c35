"""The home page, the page of help, and the page of an address that nothing has."""

import asyncio

from fastapi import APIRouter, HTTPException, Request
from fastapi.responses import HTMLResponse, Response
from starlette.routing import Match

from exercises.authoring.assignments.catalogue import assignments
from exercises.authoring.assignments.listing_index import line_counts
from service.api.health import WorkerStatus
from service.api.visible_results import visible_row
from service.auth.identity import STAFF
from service.auth.roles import CurrentUser, OptionalUser
from service.formats.grade_row import total_percent
from service.http.errors import Problem
from service.http.state import Db, Held
from service.http.templating import templates
from service.pages.course import cards
from service.store.course import course_settings, deadlines, gradebook
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
    # at the same time, because each reads all submissions of the course
    reading = [gradebook.overview(database), *([gradebook.medians(database)] if staff else [])]
    rows, *medians = await asyncio.gather(*reading)
    overview = [row for row in rows if row.slug in order and (staff or row.published)]
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
        "medians": medians[0] if medians else {},
        "standings": mine,
        "isolation": isolation or reason or "no worker is running",
    }
    return templates.TemplateResponse(request, "index.html", context)


@router.get("/help", response_class=HTMLResponse)
async def show_help(request: Request, person: OptionalUser) -> Response:
    """Show how to log in, submit, read a report and ask for a regrade."""
    return templates.TemplateResponse(request, "help.html", {})


@others.api_route("/{path:path}", methods=["GET", "POST", "PUT", "PATCH", "DELETE"])
async def not_found(request: Request, path: str, person: OptionalUser) -> Response:
    """Answer every address that nothing else answers with a page on which those who are logged in find their
    way back.
    """
    if any(route.matches(request.scope)[0] is Match.PARTIAL for route in request.app.routes):
        raise HTTPException(405)  # another route has this address, not this method
    raise Problem(404, "not-found", "nothing has this address: check it")
