"""The submission page: report, source, motions, gradings, and the student's other submissions."""

import asyncio
import json
from collections.abc import Callable, Sequence
from typing import Any
from urllib.parse import quote

from fastapi import APIRouter, Request, Response
from fastapi.responses import HTMLResponse
from markupsafe import Markup

from exercises.authoring.assignments.assignment import Assignment
from exercises.authoring.assignments.catalogue import assignments
from polhode.judging.exercise import Motion
from polhode.judging.outcome import Ended, Outcome, SceneEnd
from polhode.judging.verdict import Verdict
from polhode.report import report_html
from polhode.report.report import Report
from polhode.report.student_line import StudentLine
from service.api.figures import cached_artefact
from service.api.submissions import Submission
from service.api.visible_results import visible_row
from service.auth.identity import STAFF
from service.auth.roles import CurrentUser
from service.grading import graded_file
from service.grading.figures import motion_data, rendering
from service.http.errors import Problem
from service.http.state import Db
from service.http.templating import templates
from service.pages import markdown
from service.pages.submission import report_summary
from service.pages.submission.source_view import SIGNS, Changed, ShownCell, TooLong, cells, difference, marks
from service.store.course import comments, gradebook, overrides, regrade_requests
from service.store.submissions import records, speed_vs_accuracy
from service.store.submissions.past_submissions import gradings, previous, timeline
from service.store.submissions.records import SubmissionRecord

router = APIRouter()
PATH = "/submissions/{id}"


@router.get(PATH, response_class=HTMLResponse)
@router.get("/v1/submissions/{id}/report.html", response_class=HTMLResponse)
async def report(request: Request, person: CurrentUser, stored: Submission, database: Db) -> Response:
    """Show one submission. Staff see more details of the grading than the student."""
    commented = await comments.of_submission(database, stored.id)
    rows = [visible_row(person, row) for row in await timeline(database, stored.person, stored.assignment)]
    context = await asyncio.to_thread(_report_context, stored, commented) | {
        "stored": stored,
        "comments": commented,
        "inline": markdown.inline,
        "requests": await regrade_requests.of_submission(database, stored.id),
        "staff": person.role in STAFF,
        "gradings": await gradings(database, stored.id),
        "timeline": rows,
        "standing": report_summary.standing(stored, rows),
    }
    if context["staff"]:
        students = await gradebook.students(database, stored.assignment)
        context["neighbours"] = gradebook.beside(students, stored.person)
    if context["sweeps"]:
        how, told = await speed_vs_accuracy.ending(database, stored.grading) or ("", "")
        context["sweep"] = {
            "how": how,
            "told": json.loads(told)["line"] if how == speed_vs_accuracy.SWEPT else told,
        }
    given = {} if stored.withheld else await _overrides_context(database, stored)
    return templates.TemplateResponse(request, "report.html", context | given)


@router.get("/submissions/{id}/source")
async def download_source(person: CurrentUser, stored: Submission) -> Response:
    """Return the graded source as a file with its name."""
    named = f"attachment; filename*=UTF-8''{quote(stored.submission.filename, safe='')}"
    headers = {"Content-Disposition": named, "Cache-Control": "private, no-cache"}
    return Response(stored.submission.source, media_type="text/plain; charset=utf-8", headers=headers)


@router.get("/submissions/{id}/diff", response_class=HTMLResponse)
async def changes(request: Request, person: CurrentUser, stored: Submission, database: Db) -> Response:
    """Show the changes of the source since the student's previous submission."""
    found = await previous(database, stored.id)
    earlier = await records.read(database, found) if found else None
    if earlier is None:
        raise Problem(404, "not-found", "no earlier submission to compare with: this is the first one")
    groups = await asyncio.to_thread(_diff, earlier, stored)
    context = {"stored": stored, "earlier": earlier, "groups": groups, "signs": SIGNS}
    return templates.TemplateResponse(request, "diff.html", context)


def _report_context(stored: SubmissionRecord, commented: Sequence[comments.Comment]) -> dict[str, Any]:
    """Return the part of the context that is slow to compute: source lines, failing lines and motions."""
    assignment, report = assignments().get(stored.assignment), stored.report
    shown = cells(stored.submission, marks(report) if report else {}, commented)
    context = {
        "title": assignment.title if assignment else stored.assignment,
        "most": assignment.most_points if assignment else report and report.total,
        "out_of": assignment.out_of if assignment else report and report.out_of,
        "cells": shown,
        "lines": sum(len(cell.lines) for cell in shown),
        "sweeps": assignment is not None and report is not None and _is_measurable(assignment, report),
    }
    return context if report is None else context | _shown(stored, report, assignment, shown)


def _shown(
    stored: SubmissionRecord, report: Report, assignment: Assignment | None, source: Sequence[ShownCell]
) -> dict[str, Any]:
    """Return the part of the context that is about the report."""
    seen, motions = report.overview(), playable_motions(assignment, report) if assignment else {}
    places = {cell.name: cell.place for cell in source}

    def address(line: StudentLine | None) -> str:
        return f"#line-{places[line.cell]}-{line.number}" if line and line.cell in places else ""

    return {
        "seen": seen,
        "motions": motions,
        "beside": report_summary.beside(assignment, report, motions) if assignment else None,
        "chips": report_summary.chips(assignment, report),
        "points_shown": report_summary.points(assignment, report, stored),
        "stops": report.stops(),
        "cause_block": lambda cause: _markup(report_html.cause_block)(
            cause, source=address(cause.line), links=True
        ),
        "failure_block": _markup(report_html.failure_block),
        "outcome_item": _markup(report_html.outcome_item),
        "check_item": _markup(report_html.item),
        "judged": lambda outcome: _judged(outcome, report.scene_ends),
    }


async def _overrides_context(database: Db, stored: SubmissionRecord) -> dict[str, Any]:
    """Return the context of ``overrides.html`` for a submission."""
    found = await overrides.of_submission(database, stored.id)
    labels = {
        o.id: f"{e.number}: {o.label}"
        for e in (stored.report.exercises if stored.report else [])
        for o in e.outcomes
    }
    counted = [
        (e.number, e.title, [(o.id, o.label, o.points) for o in e.outcomes if o.counted])
        for e in (stored.report.exercises if stored.report else [])
    ]
    return {
        "overrides": found,
        "overrides_revision": overrides.revision(found),
        "check_labels": labels,
        "checks_counted": counted,
    }


def _is_measurable(assignment: Assignment, report: Report) -> bool:
    """Return whether the function whose speed and accuracy the assignment measures gave a check something to
    measure.
    """
    ran = {e.number for e in report.exercises if any(o.verdict is not Verdict.UNMEASURED for o in e.outcomes)}
    return assignment.sweep is not None and assignment.sweep_of(ran) is not None


def _markup(render: Callable[..., str]) -> Callable[..., Markup]:
    """Return the function of the kit, which escapes what it inserts, for a template that would escape its
    HTML again.
    """
    return lambda *args, **named: Markup(render(*args, **named))  # noqa: S704


def _judged(outcome: Outcome, scene_ends: list[SceneEnd]) -> str:
    """Return for the staff how the code stopped, the tolerance's numbers and their reason, and the margin."""
    state, allowed = graded_file.state(outcome, scene_ends), outcome.tolerance
    stopped = (
        f"{graded_file.MARKS[state]} {graded_file.WORDS[state]}; " if state in ("timeout", "error") else ""
    )
    text = ", ".join(f"{name} {value:.3g}" for name, value in allowed.numbers().items())
    margin = "" if outcome.margin is None else f"; margin {outcome.margin:.3g}"
    return f"{stopped}allowed {text}{': ' if text else ''}{allowed.reason}{margin}"


def _diff(earlier: SubmissionRecord, stored: SubmissionRecord) -> list[list[Changed]] | None:
    """Return the changed blocks, or None if the sources differ too much."""
    try:
        return difference(earlier.submission, stored.submission)
    except TooLong:
        return None


@router.get("/submissions/{id}/motions/{name}.json")
async def motion(
    request: Request, person: CurrentUser, stored: Submission, name: str, database: Db
) -> Response:
    """Return a motion of the report as JSON; compute it on the first request and store it."""
    assignment = assignments().get(stored.assignment)
    available = playable_motions(assignment, stored.report) if assignment and stored.report else {}
    requested = next((m for motions in available.values() for m in motions if m.name == name), None)
    if assignment is None or requested is None:
        raise Problem(404, "not-found", f"the report has no motion {name[:80]}: check the address")

    def compute(packed: bytes) -> bytes:
        return motion_data.to_json(
            assignment, requested, rendering.unpack(packed).get(requested.scene, {}), stored.seed
        )

    async def make(packed: bytes) -> bytes:
        return await asyncio.to_thread(compute, packed)

    return await cached_artefact(request, database, stored, f"motions/{name}.json", "application/json", make)


def playable_motions(assignment: Assignment, report: Report) -> dict[str, list[Motion]]:
    """Return the motions whose scene finished, by exercise number."""
    reported, finished = (
        {e.number for e in report.exercises},
        {e.scene for e in report.scene_ends if e.ended is Ended.FINISHED},
    )
    return {
        e.number: found
        for e in assignment.exercises
        if e.number in reported and (found := [m for m in e.motions if m.scene in finished])
    }
