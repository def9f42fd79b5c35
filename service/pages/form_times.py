"""Times that forms take: read in the course's time zone, and a deadline in the past only if it is meant."""

from contextlib import suppress
from datetime import UTC, datetime

from starlette.datastructures import FormData

from service.auth import forms
from service.http.errors import Problem
from service.http.templating import ZONE, format_input

# other years are typing errors; date arithmetic overflows near the ends of the calendar
YEARS = range(2000, 3000)


def moment(form: FormData, name: str) -> datetime | None:
    """Return a datetime-local field, read in the course's time zone, in UTC; None if empty. Raises Problem
    422 if it is invalid.
    """
    if not (text := forms.field(form, name, 40)):
        return None
    with suppress(ValueError):
        at = datetime.fromisoformat(text)
        if at.year in YEARS:
            return at.replace(tzinfo=ZONE.get()).astimezone(UTC) if at.tzinfo is None else at
    raise Problem(
        422,
        "invalid-request",
        f"expected a date and time such as 2026-12-01T12:00, got {text[:40]!r}",
        f"/{name}",
    )


def refuse_past(due: datetime) -> None:
    """Raise Problem 422 if the deadline of an extension is past."""
    if due <= datetime.now(UTC):
        raise Problem(422, "invalid-request", "this deadline is past: enter a later one", "/due")


def deadline(form: FormData, name: str, stored: datetime | None) -> datetime | None:
    """Return the field of a deadline, None if empty. Raises Problem 422 if it is past, unless it is the
    ``stored`` one or the form's box ``past`` is ticked.
    """
    due = moment(form, name)
    changed = forms.field(form, name, 40) != format_input(stored)
    if due is not None and changed and due <= datetime.now(UTC) and not forms.field(form, "past"):
        detail = "this deadline is past, so nobody could submit: enter a later one, or tick the box and save"
        raise Problem(422, "invalid-request", detail, f"/{name}")
    return due
