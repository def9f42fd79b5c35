"""Downloads for students: the kit as a wheel, and the notebook with this server's address."""

import asyncio

from fastapi import APIRouter, Request, Response

from exercises import wheel
from service.api.submissions import find_assignment
from service.http.errors import Problem
from service.http.openapi import media, problems
from service.http.requests import public_address

router = APIRouter()
WHEEL, NOTEBOOK = "application/zip", "application/x-ipynb+json"


@router.get("/kit/{name}", response_class=Response, responses=media(WHEEL) | problems({404: "not-found"}))
async def kit(name: str, request: Request) -> Response:
    """Return the student kit as a wheel for ``%pip install``.

    Its name changes only if old notebooks stop working with it.
    """
    if name != wheel.NAME:
        raise Problem(404, "not-found", f"no such kit: install /kit/{wheel.NAME}")
    content = await asyncio.to_thread(wheel.wheel, public_address(request))
    return Response(content, media_type=WHEEL, headers={"Cache-Control": "no-cache", "ETag": f'"{wheel.build()}"'})


@router.get(
    "/v1/assignments/{slug}/notebook.ipynb",
    response_class=Response,
    responses=media(NOTEBOOK) | problems({404: "not-found", 503: "assignment-broken"}),
)
async def notebook(slug: str, request: Request) -> Response:
    """Return the assignment's notebook, ready to run against this server."""
    assignment, server = find_assignment(slug), public_address(request)
    if not wheel.has_notebook(assignment):
        raise Problem(404, "not-found", f"the assignment {slug} has no notebook: submit a .py or .ipynb file instead")
    content = wheel.notebook(assignment, server, f"{server}/kit/{wheel.NAME}")
    headers = {"Content-Disposition": f'attachment; filename="{slug}.ipynb"', "Cache-Control": "no-cache"}
    return Response(content, media_type=NOTEBOOK, headers=headers)
