"""What the class pages change and draw: deadlines, limits, extensions, and the class's chart of speed vs
accuracy.
"""

from urllib.parse import quote

from fastapi import APIRouter, Response
from fastapi.responses import RedirectResponse

from service.api.figure_renderer import Renderer
from service.api.submissions import Assigned
from service.auth import forms
from service.auth.roles import Instructor, Staff
from service.http.errors import Problem
from service.http.state import Db, Held
from service.pages import form_times
from service.pages.class_view import class_pages
from service.pages.people import extensions
from service.pages.rejected_forms import post_form
from service.store.course import assignment_settings, gradebook
from service.store.submissions import speed_vs_accuracy

router = APIRouter()
MOST_GRACE_MIN, MOST_ALLOWED, MOST_WEIGHT = 60 * 24 * 366, 10_000, 1000


@router.get("/assignments/{slug}/class/sweep.svg")
async def class_sweep(
    person: Staff, assignment: Assigned, database: Db, renderer: Held[Renderer]
) -> Response:
    """Return the speed vs accuracy chart of the class's measured functions."""
    documents = await speed_vs_accuracy.documents(
        database, await gradebook.students(database, assignment.slug)
    )
    if not documents:
        raise Problem(
            404, "not-found", "no submission has been measured yet: start the measurement on the class page"
        )
    return Response(await renderer.class_sweep(documents), media_type="image/svg+xml")


@post_form(
    router, "/assignments/{slug}/class/sweep", page=class_pages.overview, at="/assignments/{slug}/class"
)
async def sweep_class(person: Staff, form: forms.Form, assignment: Assigned, database: Db) -> Response:
    """Queue the speed vs accuracy sweep of all counted submissions, behind all other jobs."""
    await speed_vs_accuracy.request_class(database, await gradebook.students(database, assignment.slug))
    return RedirectResponse(f"/assignments/{assignment.slug}/class#speed", 303)


@post_form(router, "/assignments/{slug}/rules", page=class_pages.show_settings, at=class_pages.SETTINGS)
async def set_rules(person: Instructor, form: forms.Form, assignment: Assigned, database: Db) -> Response:
    """Publish the assignment or make it a draft; set from when it is available, deadline, grace period,
    submission limit and weight. An empty field means no limit, and the weight 1.
    """
    stored = await gradebook.rules(database, assignment.slug)
    grace = forms.number(form, "grace", 0, MOST_GRACE_MIN, 0.0)
    most = forms.number(form, "most", 1, MOST_ALLOWED, None)
    weight = forms.number(form, "weight", 0, MOST_WEIGHT, None)
    settings = {
        "available_from": form_times.moment(form, "available_from"),
        "due_at": form_times.deadline(form, "due", stored.due_at),
        "grace_s": 60.0 * grace,
        "submission_limit": None if most is None else int(most),
        "weight": 1.0 if weight is None else weight,
    }
    if published := forms.field(form, "published"):
        settings["published"] = published == "yes"
    await assignment_settings.change(database, assignment.slug, settings, person.name)
    return RedirectResponse(f"/assignments/{assignment.slug}/class/settings", 303)


@post_form(router, "/assignments/{slug}/extensions", page=class_pages.show_settings, at=class_pages.SETTINGS)
async def extend(person: Instructor, form: forms.Form, assignment: Assigned, database: Db) -> Response:
    """Give one person a new deadline with a reason. An empty deadline removes the extension."""
    slug = assignment.slug
    name = await _login_name(database, slug, forms.field(form, "name"))
    has_one = await extensions.save_of_person(database, form, slug, name, person.name)
    removed = "" if has_one else f"?removed={quote(name, safe='')}"
    return RedirectResponse(f"/assignments/{slug}/class/settings{removed}#extensions", 303)


async def _login_name(database: Db, slug: str, name: str) -> str:
    """Return the login name of the only student with that full name, in any case, else ``name``."""
    wanted = " ".join(name.split()).casefold()
    found = [
        s.name
        for s in await gradebook.students(database, slug)
        if wanted and s.full_name.casefold() == wanted
    ]
    if len(found) > 1:
        raise Problem(
            422,
            "invalid-request",
            f"several students are named {name}: enter one of {', '.join(found)}",
            "/name",
        )
    return found[0] if found else name
