"""Downloads for students: the kit as a wheel, what it needs of an assignment, and the notebook with this
server's address.
"""

import asyncio

from fastapi import APIRouter, Request, Response

from exercises.authoring.assignments.assignment import Assignment
from exercises.authoring.publishing import public_assignment, wheel
from polhode.client import kit_hash
from service.api.submissions import Available
from service.http.errors import Problem
from service.http.openapi import media, problems
from service.http.requests import PublicAddress

router = APIRouter(tags=["Assignments"])
WHEEL, NOTEBOOK = "application/zip", "application/x-ipynb+json"


@router.get("/kit/{name}", response_class=Response, responses=media(WHEEL) | problems({404: "not-found"}))
async def kit(name: str) -> Response:
    """Return the students' kit as a wheel for ``%pip install``.

    Its name changes only if old notebooks stop working with it.
    """
    if name != kit_hash.WHEEL:
        raise Problem(404, "not-found", f"there is no kit {name}: it is /kit/{kit_hash.WHEEL}")
    content = await asyncio.to_thread(wheel.wheel)
    headers = {"Cache-Control": "no-cache", "ETag": f'"{kit_hash.build()}"'}
    return Response(content, media_type=WHEEL, headers=headers)


@router.get(
    "/v1/assignments/{slug}/kit",
    response_class=Response,
    responses=media(WHEEL) | problems({403: "not-available", 404: "not-found", 503: "assignment-broken"}),
)
async def public(assignment: Available, request: Request) -> Response:
    """Return what the kit needs of an assignment, as a zip: its public checks, data files and the course's
    packages.

    With ``If-None-Match`` the answer is 304 if they have not changed.
    """
    tag = f'"{await asyncio.to_thread(public_assignment.build, assignment.slug)}"'
    headers = {"Cache-Control": "no-cache", "ETag": tag}
    if request.headers.get("if-none-match") == tag:
        return Response(status_code=304, headers=headers)
    content = await asyncio.to_thread(public_assignment.archive, assignment.slug)
    return Response(content, media_type=WHEEL, headers=headers)


@router.get(
    "/v1/assignments/{slug}/notebook.ipynb",
    response_class=Response,
    responses=media(NOTEBOOK) | problems({403: "not-available", 404: "not-found", 503: "assignment-broken"}),
)
async def notebook(assignment: Available, server: PublicAddress) -> Response:
    """Return the assignment's notebook, ready to run against this server."""
    named = f'attachment; filename="{assignment.slug}.ipynb"'
    headers = {"Content-Disposition": named, "Cache-Control": "no-cache"}
    return Response(notebook_for(assignment, server), media_type=NOTEBOOK, headers=headers)


def notebook_for(assignment: Assignment, server: str) -> bytes:
    """Return the notebook with the address of the ``server`` and what code on it can import."""
    return wheel.notebook(assignment, server, f"{server}/kit/{kit_hash.WHEEL}")
