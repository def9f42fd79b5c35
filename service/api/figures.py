"""Figures of a report, rendered on first request, contact sheets, and the speed vs accuracy sweep."""

from collections.abc import Awaitable, Callable
from typing import Literal

from fastapi import APIRouter, Request, Response

from service.api.figure_renderer import Renderer, RenderFailed
from service.api.submissions import Submission, find_assignment, report_of
from service.grading.figures.rendering import FORMATS
from service.grading.figures.rendering import find as find_figure
from service.grading.graded_file import ARRAYS
from service.http.errors import Problem
from service.http.live_updates import Listener
from service.http.openapi import PERSON, media, problems
from service.http.state import Db, Held
from service.store.submissions import speed_vs_accuracy
from service.store.submissions.artefacts import find_artefact, store_artefacts
from service.store.submissions.records import SubmissionRecord

router = APIRouter(tags=["Figures"])
SWEEP_WAIT_S = 50.0
NOT_MODIFIED = {304: {"description": "Not modified"}}
PICTURE = PERSON | {404: "not-found", 422: "invalid-request", 503: ("assignment-broken", "busy")}


@router.get(
    "/v1/submissions/{id}/figures/{name}.{form}",
    response_class=Response,
    responses=media(*FORMATS.values()) | NOT_MODIFIED | problems(PICTURE),
)
async def figure(
    stored: Submission,
    name: str,
    form: Literal["png", "svg"],
    request: Request,
    database: Db,
    renderer: Held[Renderer],
    narrow: bool = False,
) -> Response:
    """Return a figure of the report; render it on the first request and store it. A ``narrow`` one has its
    panels one below the other.
    """
    names = {f.name for f in stored.report.figures} if stored.report else set()
    if name not in names or find_figure(await find_assignment(stored.assignment), name) is None:
        raise Problem(404, "not-found", f"the report has no figure {name[:80]}: check the address")

    async def render(packed: bytes) -> bytes:
        return await renderer.figure(stored, name, packed, form, narrow=narrow)

    stored_as = f"figures/{name}{'-narrow' if narrow else ''}.{form}"
    return await cached_artefact(request, database, stored, stored_as, FORMATS[form], render)


async def cached_artefact(
    request: Request,
    database: Db,
    stored: SubmissionRecord,
    name: str,
    media_type: str,
    make: Callable[[bytes], Awaitable[bytes]],
) -> Response:
    """Return the stored artefact ``name``; the first request makes it from the grading's packed arrays and
    stores it.

    Raises Problem 404 if the arrays are gone or cannot be drawn, and 503 if rendering fails.
    """
    if (found := await find_artefact(database, stored.grading, name)) is None:
        if (packed := await find_artefact(database, stored.grading, ARRAYS)) is None:
            raise Problem(
                404,
                "not-found",
                "the arrays of this submission are no longer stored: ask the course staff for a regrade",
            )
        try:
            content = await make(packed[0])
        except (ArithmeticError, ValueError) as error:
            raise Problem(
                404, "not-found", f"the figure cannot be drawn from these numbers: {error}"
            ) from error
        except RenderFailed as error:
            raise Problem(503, "busy", "rendering the figure failed: reload the page to try again") from error
        await store_artefacts(database, stored.grading, {name: content})
        found = await find_artefact(database, stored.grading, name)
        assert found is not None
    return _cached(request, found, media_type)


@router.get(
    "/v1/submissions/{id}/sweep.{form}",
    response_class=Response,
    responses=media("application/json", FORMATS["svg"], model="SweepResult")
    | NOT_MODIFIED
    | problems(PICTURE | {409: "not-ready"}),
)
async def speed_against_accuracy(
    stored: Submission, form: Literal["json", "svg"], request: Request, database: Db, listener: Held[Listener]
) -> Response:
    """Return the speed vs accuracy sweep of the submission's function; a worker runs it on the first
    request.
    """
    report_of(stored)
    async for _ in listener.wait_for_changes(str(stored.id), SWEEP_WAIT_S):
        if found := await find_artefact(database, stored.grading, f"sweep.{form}"):
            return _cached(request, found, FORMATS.get(form, "application/json"))
        if failure := await find_artefact(database, stored.grading, speed_vs_accuracy.REFUSED):
            raise Problem(
                404, "not-found", f"the speed vs accuracy measurement failed: {failure[0].decode()}"
            )
        if fault := await speed_vs_accuracy.request(database, stored.grading):
            raise Problem(
                409,
                "not-ready",
                f"polhode failed to measure speed vs accuracy: {fault}; ask the course staff",
            )
    raise Problem(503, "busy", "the speed vs accuracy measurement is still running: try again later")


@router.get(
    "/v1/submissions/{id}/animations/{name}.png",
    response_class=Response,
    responses=media(FORMATS["png"]) | NOT_MODIFIED | problems(PERSON | {404: "not-found"}),
)
async def animation(stored: Submission, name: str, request: Request, database: Db) -> Response:
    """Return the contact sheet of an animation."""
    names = {a.name for a in stored.report.animations} if stored.report else set()
    found = await find_artefact(database, stored.grading, f"animations/{name}.png") if name in names else None
    if found is None:
        raise Problem(404, "not-found", f"the report has no animation {name[:80]}: check the address")
    return _cached(request, found, FORMATS["png"])


def _cached(request: Request, found: tuple[bytes, str], media_type: str) -> Response:
    content, digest = found
    # A regrade replaces the picture at the same URL, so clients must revalidate.
    headers = {"ETag": f'"{digest}"', "Cache-Control": "private, no-cache"}
    tags = {tag.strip().removeprefix("W/") for tag in request.headers.get("if-none-match", "").split(",")}
    if tags & {headers["ETag"], "*"}:
        return Response(status_code=304, headers=headers)
    return Response(content, media_type=media_type, headers=headers)
