"""Settings of the course: name, term, time zone, late penalty, weights, and when the students see scores."""

from collections.abc import Sequence
from typing import Any
from zoneinfo import available_timezones

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse, RedirectResponse, Response
from starlette.datastructures import FormData

from exercises.authoring.assignments.catalogue import assignments
from service.api.submissions import Assigned
from service.auth import forms
from service.auth.roles import Instructor, Staff
from service.http.errors import Problem
from service.http.state import Db
from service.http.templating import ZONE, find_zone, templates
from service.pages.class_view import class_pages
from service.pages.rejected_forms import post_form
from service.store.course import assignment_settings, course_settings, gradebook
from service.store.course.assignment_settings import RELEASES
from service.store.course.course_settings import CourseSettings
from service.store.database import Row, is_outage

router = APIRouter()
MOST_WEIGHT = 1000
MOST_NAME = 200  # characters of the course's name, and of its term


async def use_course_zone(database: Db) -> None:
    """Show and read times in the course's time zone while this request is answered; in UTC during an outage
    of the database.
    """
    try:
        ZONE.set(find_zone((await course_settings.read(database)).time_zone))
    except Exception as error:
        if not is_outage(error):
            raise


def zones() -> list[str]:
    """Return the time zones that a course can have."""
    return sorted({"UTC", *available_timezones()})


@router.get("/settings", response_class=HTMLResponse)
async def show(request: Request, person: Staff, database: Db) -> Response:
    """Show the settings of the course; instructors can change them."""
    context = {
        "settings": await course_settings.read(database),
        "rows": await overview(database),
        "assignments": assignments(),
        "zones": zones(),
    }
    return templates.TemplateResponse(request, "course_settings.html", context)


@post_form(router, "/settings", page=show, at="/settings")
async def save(person: Instructor, form: forms.Form, database: Db) -> Response:
    """Save name and term, time zone, late penalty and the weights of the assignments."""
    settings = CourseSettings(
        **about_course(form),
        late_penalty=_percent(form, "late_penalty", 0.0),
        late_penalty_limit=_percent(form, "late_penalty_limit", 100.0),
    )
    weights = {
        row.slug: forms.number(form, name, 0, MOST_WEIGHT, float(row.weight))
        for row in await overview(database)
        if (name := f"weight-{row.slug}") in form
    }
    await course_settings.change(database, settings, weights, person.name)
    return RedirectResponse("/settings", 303)


@post_form(router, "/assignments/{slug}/release", page=class_pages.show_settings, at=class_pages.SETTINGS)
async def set_release(person: Instructor, form: forms.Form, assignment: Assigned, database: Db) -> Response:
    """Set when the students see scores and the details of hidden checks, or release them or withdraw the
    release now.
    """
    slug, action = assignment.slug, forms.field(form, "action")
    if what := {"scores": "scores", "details": "details"}.get(action.partition(" ")[2]):
        released = action.startswith("release ")
        chosen = {
            "scores": released if what == "scores" else None,
            "details": released if what == "details" else None,
        }
        await assignment_settings.release(database, slug, **chosen, actor=person.name)
    else:
        scores, details = (_release(form, name) for name in ("scores", "details"))
        changes = {"scores_release": scores, "details_release": details}
        await assignment_settings.change(database, slug, changes, person.name)
    return RedirectResponse(f"/assignments/{slug}/class/settings#release", 303)


def about_course(form: FormData) -> dict[str, Any]:
    """Return name, term and time zone of the course in a form. Raises Problem 422 for an unknown zone."""
    zone = forms.field(form, "time_zone") or "UTC"
    if str(find_zone(zone)) != zone:
        raise Problem(
            422,
            "invalid-request",
            f"no time zone {zone[:80]}: enter a name such as Europe/Berlin",
            "/time_zone",
        )
    return {
        "title": forms.field(form, "title", MOST_NAME),
        "term": forms.field(form, "term", MOST_NAME),
        "time_zone": zone,
    }


async def overview(database: Db) -> Sequence[Row]:
    """Return the gradebook's row of each assignment that this server has."""
    return [row for row in await gradebook.overview(database) if row.slug in assignments()]


def _release(form: FormData, name: str) -> str:
    if (chosen := forms.field(form, name)) not in RELEASES:
        raise Problem(422, "invalid-request", f"choose one of {', '.join(RELEASES)}", f"/{name}")
    return chosen


def _percent(form: FormData, name: str, default: float) -> float:
    return forms.number(form, name, 0, 100, default) / 100
