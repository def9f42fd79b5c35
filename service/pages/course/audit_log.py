"""The page of the audit log."""

from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import HTMLResponse, Response

from service.auth.roles import Staff
from service.http.state import Db
from service.http.templating import templates
from service.pages.course.audit_text import tell
from service.store.course.audit import MOST, entries

router = APIRouter()


@router.get("/audit", response_class=HTMLResponse)
async def audit_log(
    request: Request,
    person: Staff,
    database: Db,
    subject: Annotated[str, Query(max_length=200)] = "",
    before: Annotated[int | None, Query(ge=0, le=2**62)] = None,
) -> Response:
    """Show the latest entries in words, optionally of one person or subject."""
    subject = subject.strip().replace("\x00", "")
    rows = await entries(database, subject or None, before)
    older = rows[-1].id if len(rows) == MOST else None
    context = {"entries": [*map(tell, rows)], "subject": subject, "older": older}
    return templates.TemplateResponse(request, "audit.html", context)
