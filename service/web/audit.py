"""The audit trail as a page: who of the staff did what, to whom and why."""

from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import HTMLResponse, Response

from service.store.trail import MOST, trail
from service.web.roles import Staff
from service.web.templating import templates

router = APIRouter()


@router.get("/audit", response_class=HTMLResponse)
async def page(
    request: Request,
    person: Staff,
    subject: Annotated[str, Query(max_length=200)] = "",
    before: Annotated[int | None, Query(ge=0, le=2**62)] = None,
) -> Response:
    """The latest entries, of all or about one subject or person."""
    subject = subject.strip().replace("\x00", "")
    rows = await trail(request.app.state.database, subject or None, before)
    context = {"rows": rows, "subject": subject, "older": rows[-1].id if len(rows) == MOST else None}
    return templates.TemplateResponse(request, "audit.html", context)
