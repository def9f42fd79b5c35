"""The audit log in words: what was done, to what, and the values before and after."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from exercises.authoring.assignments.catalogue import assignments
from service.http.templating import ZONE, format_span
from service.store.course.audit import NEW, OLD
from service.store.database import Row
from service.store.people.people import COURSE

ACTIONS = {
    "add person": "added",
    "assignment settings": "changed the settings of",
    "cancel": "cancelled a grading of",
    "comment": "commented on",
    "comment deleted": "deleted a comment on",
    "connect sign-in": "connected a sign-in to",
    "course settings": "changed the settings of",
    "disconnect sign-in": "disconnected the sign-in of",
    "extension": "gave an extension to",
    "first instructor": "became the first instructor as",
    "extension taken back": "took back the extension of",
    "give token": "gave a token to",
    "log in": "logged in as",
    "log out everywhere": "logged out all browsers of",
    "note": "wrote a note on",
    "note removed": "removed a note on",
    "override": "overrode points of",
    "override withdrawn": "withdrew an override of",
    "person": "changed",
    "regrade": "regraded",
    "regrade applied": "applied",
    "regrade begun": "began",
    "regrade dropped": "dropped",
    "regrade request": "requested a regrade of",
    "regrade request accepted": "accepted the regrade request for",
    "regrade request declined": "declined the regrade request for",
    "release": "released, or withdrew from, the students of",
    "revoke token": "revoked tokens of",
    "roster": "imported the roster",
    "set password": "set the password of",
    "view as": "saw the pages as",
}
"""What was done, by the recorded action; others are shown as they are."""

FIELDS = {
    "available_from": "available from",
    "check": "check",
    "count": "number",
    "details_release": "release of details",
    "due": "deadline",
    "due_at": "deadline",
    "full_name": "full name",
    "grace_s": "grace period",
    "late_penalty": "late penalty per day",
    "late_penalty_limit": "late penalty at most",
    "scores_release": "release of scores",
    "student_id": "student ID",
    "submission_limit": "submissions per person",
    "time_zone": "time zone",
    "title": "name",
}
"""The words for recorded names that are not words already."""

SUBMISSION, REGRADE = "submission", "regrade"
KINDS = {
    **dict.fromkeys(("regrade begun", "regrade applied", "regrade dropped"), REGRADE),
    **dict.fromkeys(
        (
            "cancel", "comment", "comment deleted", "override", "override withdrawn", "regrade",
            "regrade request", "regrade request accepted", "regrade request declined",
        ),
        SUBMISSION,
    ),
}  # fmt: skip
"""What the subject of an action is, if it has a page of its own."""


@dataclass(frozen=True)
class Value:
    """A value of an entry: its name in words, and the value before, "" if none is recorded, and after."""

    name: str
    before: str
    after: str


@dataclass(frozen=True)
class Told:
    """An entry in words. ``kind`` is "submission", "regrade" or "": the page that ``subject`` has."""

    at: datetime
    actor: str
    action: str
    subject: str
    about: str
    kind: str
    values: list[Value]


def tell(row: Row) -> Told:
    """Return an entry of the audit log in words, with times in the time zone of the request."""
    kind = KINDS.get(row.action, "")
    about = f"{kind} {row.subject[:8]}" if kind else _title(row.subject, row.action)
    values = [_value(name, value) for name, value in row.detail.items() if value is not None]
    return Told(row.at, row.actor, ACTIONS.get(row.action, row.action), row.subject, about, kind, values)


def _title(subject: str, action: str) -> str:
    if action == "course settings" and subject == COURSE:
        return "the course"
    assignment = assignments().get(subject) if action in ("assignment settings", "release") else None
    return assignment.title if assignment else subject


def _value(name: str, value: object) -> Value:
    words = FIELDS.get(name, name.replace("_", " "))
    if isinstance(value, Mapping) and value.keys() == {OLD, NEW}:
        return Value(words, _text(name, value[OLD]), _text(name, value[NEW]))
    return Value(words, "", _text(name, value))


def _text(name: str, value: Any) -> str:
    """Return a value as it is read: times in the time zone of the request, spans, percent, yes and no."""
    if value is None or value == "":
        return "none"
    if name in FORMATS:
        return FORMATS[name](value)
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, Mapping):
        return ", ".join(f"{key} {one}" for key, one in value.items())
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)


def _time(value: str) -> str:
    return f"{datetime.fromisoformat(value).astimezone(ZONE.get()):%Y-%m-%d %H:%M}"


def _percent(value: float) -> str:
    return f"{100 * value:g} %"


FORMATS: Mapping[str, Callable[[Any], str]] = {
    "available_from": _time,
    "due": _time,
    "due_at": _time,
    "grace_s": format_span,
    "late_penalty": _percent,
    "late_penalty_limit": _percent,
}
"""How recorded values are shown, by name."""
