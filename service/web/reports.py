"""A report's other tellings: as the notebook prints it, and as JUnit XML."""

import asyncio
from pathlib import Path

from fastapi import APIRouter, Request
from fastapi.responses import PlainTextResponse, Response

from ecp.report import Report
from service.store.records import Stored
from service.tellings import junit
from service.tellings.files import GradedFile
from service.web.problems import Problem
from service.web.routes import find_assignment, find_submission

router = APIRouter()


@router.get("/v1/submissions/{id}/report.txt")
async def report_text(id: str, request: Request) -> PlainTextResponse:
    """The report as the notebook prints it."""
    _, report = await _graded(request, id)
    return PlainTextResponse(report.text())


@router.get("/v1/submissions/{id}/report.junit.xml")
async def report_junit(id: str, request: Request) -> Response:
    """The report as JUnit XML, for CI systems."""
    stored, report = await _graded(request, id)
    seconds = sum(report.provenance.phases_ms.values()) / 1e3
    file = GradedFile(file=Path(stored.submission.filename), source=stored.submission.source, report=report, seconds=seconds)
    return Response(await asyncio.to_thread(junit.text, [file], find_assignment(stored.assignment)), media_type="application/xml")


async def _graded(request: Request, id: str) -> tuple[Stored, Report]:
    """The submission with its report; a 409 problem where it has none."""
    stored = await find_submission(request, id)
    if stored.report is None:
        raise Problem(409, "not-ready", stored.fault or "the submission has not been graded yet")
    return stored, stored.report
