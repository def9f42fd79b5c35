"""Downloads for students: the kit as a wheel, and the notebook with this server's address."""

import asyncio

from fastapi import APIRouter, Response

from exercises import wheel
from exercises.catalogue import assignments
from service.api.submissions import Assigned
from service.http.errors import Problem
from service.http.openapi import media, problems
from service.http.requests import PublicAddress

router = APIRouter(tags=["Assignments"])
WHEEL, NOTEBOOK = "application/zip", "application/x-ipynb+json"


@router.get("/kit/{name}", response_class=Response, responses=media(WHEEL) | problems({404: "not-found"}))
async def kit(name: str, server: PublicAddress) -> Response:
    """Return the student kit of an assignment as a wheel for ``%pip install``.

    Its name changes only if old notebooks stop working with it.
    """
    slugs = {wheel.filename(slug): slug for slug in assignments()}
    if name not in slugs:
        raise Problem(
            404,
            "not-found",
            f"there is no kit {name}: GET /v1/assignments/SLUG returns the path of an assignment's kit",
        )
    content = await asyncio.to_thread(wheel.wheel, slugs[name], server)
    headers = {"Cache-Control": "no-cache", "ETag": f'"{wheel.build(slugs[name])}"'}
    return Response(content, media_type=WHEEL, headers=headers)


@router.get(
    "/v1/assignments/{slug}/notebook.ipynb",
    response_class=Response,
    responses=media(NOTEBOOK) | problems({404: "not-found", 503: "assignment-broken"}),
)
async def notebook(assignment: Assigned, server: PublicAddress) -> Response:
    """Return the assignment's notebook, ready to run against this server."""
    slug = assignment.slug
    content = wheel.notebook(assignment, server, f"{server}/kit/{wheel.filename(slug)}")
    headers = {"Content-Disposition": f'attachment; filename="{slug}.ipynb"', "Cache-Control": "no-cache"}
    return Response(content, media_type=NOTEBOOK, headers=headers)
