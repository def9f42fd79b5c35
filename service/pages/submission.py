"""The page of one submission: its report, source, motions, what it cost, and the person's other submissions."""

import asyncio
from typing import Any

from fastapi import APIRouter, Request, Response
from fastapi.responses import HTMLResponse

from ecp import grouped
from ecp.exercise import Motion
from ecp.outcome import Ended, Outcome
from ecp.report import Report
from exercises.assignment import Assignment
from exercises.catalogue import assignments
from service.api.figures import Submission, cached_artefact
from service.api.submissions import find_submission
from service.auth.identity import STAFF
from service.auth.roles import CurrentUser
from service.grading import motion_data, rendering, result
from service.grading.submission import source_locations
from service.http.errors import Problem
from service.http.templating import templates
from service.pages import overrides
from service.pages.source import SIGNS, Changed, TooLong, cells, difference
from service.store import records
from service.store.history import gradings, previous, timeline
from service.store.records import SubmissionRecord

router = APIRouter()


@router.get("/submissions/{id}", response_class=HTMLResponse)
@router.get("/v1/submissions/{id}/report.html", response_class=HTMLResponse)
async def report(id: str, request: Request, person: CurrentUser) -> Response:
    """One submission; the staff see more of how it was graded than whoever sent it."""
    stored, database = await find_submission(request, id), request.app.state.database
    context = await asyncio.to_thread(_shown, stored) | {
        "stored": stored,
        "staff": request.state.role in STAFF,
        "gradings": await gradings(database, stored.id),
        "timeline": await timeline(database, stored.person, stored.assignment),
    }
    return templates.TemplateResponse(request, "report.html", context | await overrides.context(request, stored))


@router.get("/submissions/{id}/diff", response_class=HTMLResponse)
async def changes(id: str, request: Request, person: CurrentUser) -> Response:
    """How the source differs from that of the same person's submission before it."""
    stored, database = await find_submission(request, id), request.app.state.database
    found = await previous(database, stored.id)
    earlier = await records.read(database, found) if found else None
    if earlier is None:
        raise Problem(404, "not-found", "no earlier submission is known to compare this one with")
    groups = await asyncio.to_thread(_compared, earlier, stored)
    context = {"stored": stored, "earlier": earlier, "groups": groups, "signs": SIGNS}
    return templates.TemplateResponse(request, "diff.html", context)


def _shown(stored: SubmissionRecord) -> dict[str, Any]:
    """What the page needs and takes time: the source, line by line, and where its failing lines are."""
    scene_ends = stored.report.scene_ends if stored.report else []
    shown = cells(stored.submission, scene_ends)
    known = {cell.name: cell.place for cell in shown}
    assignment = assignments().get(stored.assignment)
    return {
        "cells": shown,
        "lines": sum(len(cell.lines) for cell in shown),
        "stops": [
            (number, scene_end, [(known[p.cell], p) for p in source_locations(scene_end) if p.cell in known])
            for number, scene_end in enumerate(scene_ends)
            if scene_end.traceback
        ],
        "motions": played_in(assignment, stored.report) if assignment and stored.report else {},
        "sweeps": assignment is not None and assignment.sweep is not None,
        "state": lambda outcome: result.state(outcome, scene_ends),
        "tolerance": _tolerance,
        "cause_numbers": grouped.numbers,
        "causes_header": grouped.header,
    }


def _tolerance(outcome: Outcome) -> str:
    """The numbers that were allowed, and why just these."""
    allowed = outcome.tolerance
    numbers = {"rtol": allowed.rtol, "atol": allowed.atol, "limit": allowed.limit}
    told = ", ".join(f"{name} {value:.3g}" for name, value in numbers.items() if value is not None)
    return f"{told}: {allowed.reason}" if told else allowed.reason


def _compared(earlier: SubmissionRecord, stored: SubmissionRecord) -> list[list[Changed]] | None:
    """The changed stretches; None where they are too long to be found."""
    try:
        return difference(earlier.submission, stored.submission)
    except TooLong:
        return None


@router.get("/submissions/{id}/motions/{name}.json")
async def show(person: CurrentUser, stored: Submission, name: str, request: Request) -> Response:
    """A motion of the report, made when first asked for and kept."""
    assignment = assignments().get(stored.assignment)
    played = played_in(assignment, stored.report) if assignment and stored.report else {}
    asked = next((m for motions in played.values() for m in motions if m.name == name), None)
    if assignment is None or asked is None:
        raise Problem(404, "not-found", f"the report has no motion {name[:80]}")

    def made(packed: bytes) -> bytes:
        return motion_data.to_json(assignment, asked, rendering.unpack(packed).get(asked.scene, {}), stored.seed)

    async def make(packed: bytes) -> bytes:
        return await asyncio.to_thread(made, packed)

    return await cached_artefact(request, stored, f"motions/{name}.json", "application/json", make)


def played_in(assignment: Assignment, report: Report) -> dict[str, list[Motion]]:
    """The motions that can be played, by the number of their exercise: of its exercises, those whose scene was finished."""
    told, finished = {e.number for e in report.exercises}, {e.scene for e in report.scene_ends if e.ended is Ended.FINISHED}
    return {
        e.number: found
        for e in assignment.exercises
        if e.number in told and (found := [m for m in e.motions if m.scene in finished])
    }
