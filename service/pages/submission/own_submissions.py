"""A person's page of an assignment: the task, the notebook to read, the own submissions, and the upload of
another.
"""

import asyncio
from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import HTMLResponse, RedirectResponse, Response

from service.api.kit import notebook_for
from service.api.past_submissions import list_own
from service.api.submissions import Available, Stored
from service.auth import forms
from service.auth.roles import CurrentUser
from service.http.requests import PublicAddress
from service.http.state import Db
from service.http.templating import templates
from service.pages import markdown
from service.pages.rejected_forms import post_form
from service.pages.submission import exercise_list
from service.store.course import course_settings

router = APIRouter()


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
    context |= {
        "exercises": exercise_list.exercises(assignment, best),
        "limits": exercise_list.limits(assignment),
    }
    return templates.TemplateResponse(request, "submissions.html", context)


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
