"""Pictures of a report: figures drawn when somebody looks, contact sheets, and the sweep of a submission's own function."""

from collections.abc import Awaitable, Callable
from typing import Annotated, Literal

from fastapi import APIRouter, Depends, Request, Response

from service.api.renderer import RenderFailed
from service.api.submissions import find_assignment, find_submission
from service.grading.rendering import FORMATS
from service.grading.rendering import find as find_figure
from service.http.errors import Problem
from service.store import sweeps
from service.store.records import SubmissionRecord, find_artefact, store_artefacts

router = APIRouter()
Submission = Annotated[SubmissionRecord, Depends(find_submission)]
SWEPT_IN_S = 50.0


@router.get("/v1/submissions/{id}/figures/{name}.{form}")
async def figure(stored: Submission, name: str, form: Literal["png", "svg"], request: Request) -> Response:
    """A figure of the report, drawn when first asked for and kept."""
    known = {f.name for f in stored.report.figures} if stored.report else set()
    if name not in known or find_figure(find_assignment(stored.assignment), name) is None:
        raise Problem(404, "not-found", f"the report has no figure {name[:80]}")

    async def draw(packed: bytes) -> bytes:
        drawn: bytes = await request.app.state.renderer.figure(stored, name, packed, form)
        return drawn

    return await cached_artefact(request, stored, f"figures/{name}.{form}", FORMATS[form], draw)


async def cached_artefact(
    request: Request, stored: SubmissionRecord, name: str, media_type: str, make: Callable[[bytes], Awaitable[bytes]]
) -> Response:
    """The artefact ``name``; the first who asks has it made of the grading's packed arrays, and it is kept."""
    database = request.app.state.database
    if (found := await find_artefact(database, stored.grading, name)) is None:
        packed = await find_artefact(database, stored.grading, "arrays.npz")
        if packed is None:
            raise Problem(404, "not-found", "the arrays of this submission are gone")
        try:
            content = await make(packed[0])
        except (ArithmeticError, ValueError) as error:
            raise Problem(404, "not-found", f"these numbers cannot be drawn: {error}") from error
        except RenderFailed as error:
            raise Problem(503, "busy", "the picture could not be drawn: ask again") from error
        await store_artefacts(database, stored.grading, {name: content})
        found = await find_artefact(database, stored.grading, name)
        assert found is not None
    return _cached(request, found, media_type)


@router.get("/v1/submissions/{id}/sweep.{form}")
async def speed_against_accuracy(stored: Submission, form: Literal["json", "svg"], request: Request) -> Response:
    """Speed against accuracy of the submission's own function, played by a worker when first asked for, and kept."""
    if stored.report is None:
        raise Problem(409, "not-ready", stored.fault or "the submission has not been graded yet")
    database = request.app.state.database
    async for _ in request.app.state.listener.wait_for_changes(str(stored.id), SWEPT_IN_S):
        if found := await find_artefact(database, stored.grading, f"sweep.{form}"):
            return _cached(request, found, FORMATS.get(form, "application/json"))
        if refused := await find_artefact(database, stored.grading, "sweep.refused"):
            raise Problem(404, "not-found", f"this function could not be swept: {refused[0].decode()}")
        await sweeps.request(database, stored.grading)
    raise Problem(503, "busy", "the sweep has not been played yet: ask again later")


@router.get("/v1/submissions/{id}/animations/{name}.png")
async def animation(stored: Submission, name: str, request: Request) -> Response:
    """The contact sheet of an animation."""
    known = {a.name for a in stored.report.animations} if stored.report else set()
    database = request.app.state.database
    found = await find_artefact(database, stored.grading, f"animations/{name}.png") if name in known else None
    if found is None:
        raise Problem(404, "not-found", f"the report has no animation {name[:80]}")
    return _cached(request, found, FORMATS["png"])


def _cached(request: Request, found: tuple[bytes, str], media_type: str) -> Response:
    content, digest = found
    headers = {"ETag": f'"{digest}"', "Cache-Control": "private, no-cache"}  # after a regrade there is another at the same address
    wanted = {tag.strip().removeprefix("W/") for tag in request.headers.get("if-none-match", "").split(",")}
    if wanted & {headers["ETag"], "*"}:
        return Response(status_code=304, headers=headers)
    return Response(content, media_type=media_type, headers=headers)
