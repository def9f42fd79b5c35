"""Regrade pages: start a regrade, preview its changes, then apply or drop it."""

import weakref
from collections import Counter, defaultdict
from collections.abc import AsyncIterator, Iterable, Mapping, Sequence
from typing import Annotated, Any
from uuid import UUID

from fastapi import APIRouter, Depends, Header, Request
from fastapi.responses import HTMLResponse, RedirectResponse, Response
from fastapi.sse import EventSourceResponse, ServerSentEvent

from exercises.authoring.assignments.assignment import Assignment
from service.api.submissions import Assigned, find_assignment
from service.auth.forms import Form, field
from service.auth.roles import Instructor, Staff
from service.grading.graded_file import MARKS, WORDS
from service.http.errors import Problem
from service.http.live_updates import ChangeFeed, Listener
from service.http.requests import identifier
from service.http.state import Db, Held
from service.http.templating import templates
from service.pages.class_view import class_pages
from service.pages.queue import Queue
from service.pages.rejected_forms import post_form
from service.pages.submission import page as submission
from service.store.course import regrades
from service.store.course.regrades import BEST, EVERY, Regrade
from service.store.database import Row
from service.store.submissions import records

router = APIRouter()
LIST = "/assignments/{slug}/regrades"
_feeds: weakref.WeakValueDictionary[UUID, ChangeFeed[Any]] = weakref.WeakValueDictionary()  # of open pages
GROUPS = ("gains", "loses", "unchanged", "faults", "overtaken")
MOST_CHANGED = 12


async def _find(id: str, database: Db) -> Regrade:
    found = await regrades.find(database, identifier(id))
    if found is None:
        raise Problem(404, "not-found", "no such regrade: check the address")
    return found


Found = Annotated[Regrade, Depends(_find)]


@router.get(LIST, response_class=HTMLResponse)
async def list_regrades(request: Request, person: Staff, assignment: Assigned, database: Db) -> Response:
    """Show the regrades of an assignment and the form that starts one."""
    context = {"assignment": assignment, "labels": check_labels(assignment)}
    context["regrades"] = await regrades.of_assignment(database, assignment.slug)
    return templates.TemplateResponse(request, "regrades.html", context)


@post_form(
    router, "/assignments/{slug}/submissions/{id}/regrades", page=submission.report, at=submission.PATH
)
@post_form(router, class_pages.SUBMISSIONS, page=class_pages.show_submissions, at=class_pages.SUBMISSIONS)
@post_form(router, LIST, page=list_regrades, at=LIST)
async def create(person: Staff, form: Form, assignment: Assigned, database: Db, queue: Queue) -> Response:
    """Start a preview regrade of the selected submissions. Shown results do not change."""
    which, check, description = await _selection(
        database, assignment, field(form, "which"), field(form, "check")
    )
    try:
        id = await regrades.create(
            database, assignment.slug, which, person.name, check=check, description=description
        )
    except regrades.NothingToGrade:
        raise Problem(
            409,
            "not-ready",
            f"nothing to regrade ({description}): no submission matches, or all are being graded",
        ) from None
    queue.invalidate()
    return RedirectResponse(f"/regrades/{id}", 303)


@router.get("/regrades/{id}", response_class=HTMLResponse)
async def page(request: Request, person: Staff, regrade: Found, database: Db) -> Response:
    """Show the regrade's progress and changes."""
    pairs, flips = (
        await regrades.score_changes(database, regrade.id),
        await regrades.check_changes(database, regrade.id),
    )
    assignment = await find_assignment(regrade.assignment)
    context: dict[str, Any] = {
        "regrade": regrade,
        "assignment": assignment,
        "diff": diff(pairs, flips, check_labels(assignment)),
    }
    role = person.role
    context["may_drop"] = regrade.decided is None and (
        role == "instructor" or person.name == regrade.requested_by
    )
    context["may_apply"] = (
        regrade.decided is None and role == "instructor" and regrade.finished == regrade.total
    )
    return templates.TemplateResponse(request, "regrade.html", context)


@router.get("/regrades/{id}/events", response_class=EventSourceResponse)
async def events(
    person: Staff,
    regrade: Found,
    database: Db,
    listener: Held[Listener],
    last_event_id: Annotated[str | None, Header()] = None,
) -> AsyncIterator[ServerSentEvent]:
    """Send an event whenever the regrade progresses or is decided, at most once per second."""
    async for event in _feed(database, listener, regrade.id).events(last_event_id):
        yield event


@post_form(router, "/regrades/{id}/apply", page=page, at="/regrades/{id}")
async def apply(person: Instructor, form: Form, regrade: Found, database: Db) -> Response:
    """Make the new results the shown ones."""
    try:
        await regrades.apply(database, regrade.id, person.name)
    except regrades.RegradeIncomplete as error:
        raise Problem(409, "not-ready", f"the regrade cannot be applied yet: {error}") from None
    except regrades.RegradeClosed as error:
        raise Problem(409, "changed-meanwhile", str(error)) from None
    return RedirectResponse(f"/regrades/{regrade.id}", 303)


@post_form(router, "/regrades/{id}/drop", page=page, at="/regrades/{id}")
async def drop(person: Staff, form: Form, regrade: Found, database: Db, queue: Queue) -> Response:
    """Drop a regrade and keep the shown results."""
    if person.role != "instructor" and person.name != regrade.requested_by:
        raise Problem(
            403,
            "not-allowed",
            "you don't have permission: only instructors and the person who requested the regrade can"
            " drop it",
        )
    try:
        await regrades.drop(database, regrade.id, person.name)
    except regrades.RegradeClosed as error:
        raise Problem(409, "changed-meanwhile", str(error)) from None
    queue.invalidate()
    return RedirectResponse(f"/regrades/{regrade.id}", 303)


async def _selection(
    database: Db, assignment: Assignment, which: str, check: str
) -> tuple[UUID | str, str | None, str]:
    """Return the submissions that the form selects, the check that they do not pass (or None), and a
    description.
    """
    if which == "check":
        if check not in check_labels(assignment):
            raise Problem(
                422, "invalid-request", f"the assignment has no check {check[:80]}: select another", "/check"
            )
        return BEST, check, f"counted submissions that do not pass {check}"
    if which in (BEST, EVERY):
        return (
            which,
            None,
            "everybody's counted submission" if which == BEST else "all submissions of everybody",
        )
    if not which:
        raise Problem(
            422, "invalid-request", "select submissions: all, every, check, or the id of one", "/which"
        )
    stored = await records.read(database, identifier(which))
    if stored is None or stored.assignment != assignment.slug:
        raise Problem(404, "not-found", f"{assignment.slug} has no submission {which[:80]}: check the id")
    return stored.id, None, f"one submission of {stored.person}"


def _feed(database: Db, listener: Listener, id: UUID) -> ChangeFeed[Regrade | None]:
    """Return the feed that all viewers of the regrade on this server share."""
    if (feed := _feeds.get(id)) is None:
        feed = _feeds[id] = ChangeFeed(listener, lambda: regrades.find(database, id), lambda regrade: regrade)
    return feed


def diff(pairs: Sequence[Row], changes: Iterable[Row], labels: Mapping[str, str]) -> dict[str, Any]:
    """Return the finished submissions by group, the most frequently changed checks, and the compared
    versions.
    """
    by_grading: dict[UUID, list[dict[str, str]]] = defaultdict(list)
    kinds: Counter[tuple[str, str]] = Counter()
    for change in changes:
        marks = f"{_mark(change.was)} → {_mark(change.now)}"
        if change.was == change.now:  # the partial credit changed, or what the check is worth
            marks += f", {change.was_points} → {change.now_points} points"
        check = {"check": change.check_id, "label": labels.get(change.check_id, "")}
        by_grading[change.grading].append(
            check | {"marks": marks, "description": f"{_label(change.was)}, now {_label(change.now)}"}
        )
        kinds[change.check_id, marks] += 1
    groups: dict[str, list[dict[str, Any]]] = {name: [] for name in GROUPS}
    for row in pairs:
        if row.finished:
            groups[_group(row)].append(row._asdict() | {"flips": by_grading[row.grading]})
    most_changed = [
        {"check": id, "label": labels.get(id, ""), "marks": marks, "count": count}
        for (id, marks), count in kinds.most_common(MOST_CHANGED)
    ]
    versions = {
        side: sorted({v for row in pairs if (v := getattr(row, side))}) for side in ("was_version", "version")
    }
    return {
        "groups": groups,
        "changed_checks": most_changed,
        "from": versions["was_version"],
        "to": versions["version"],
    }


def check_labels(assignment: Assignment) -> dict[str, str]:
    """Return the labels of all checks, with their exercise, by check id."""
    return {c.id: f"{e.number}: {c.label}" for e in assignment.exercises for c in e.checks}


def _group(row: Row) -> str:
    if row.fault is not None:
        return "faults"
    if row.overtaken:
        return "overtaken"
    if row.was_points == row.points:
        return "unchanged"
    return "gains" if row.was_points is None or row.points > row.was_points else "loses"


def _mark(state: str | None) -> str:
    return MARKS.get(state or "", "(none)")


def _label(state: str | None) -> str:
    return WORDS.get(state or "", "absent")
