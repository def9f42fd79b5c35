"""Error answers put into words: what happened, and what a student can do about it."""

import json
from collections.abc import Mapping
from datetime import UTC, datetime
from email.utils import parsedate_to_datetime
from typing import Any

from ecp.answers import Answer, Refused, place

PASSING = (429, 502, 503, 504)
LONGEST_DETAIL, SHORTEST_TOKEN = 500, 6
SENTENCES = {
    "nobody": "The server at {place} does not know who you are{detail}: run ecp.login() and try again.",
    "deadline-over": "The deadline is over{detail}: nothing was submitted.",
    "none-left": "You have no submission left{detail}: nothing was submitted.",
    "too-large": "What you send is too large for the server at {place}{detail}: clear the outputs or send less.",
    "busy": "The server at {place} is busy and does not take this now{detail}: try again in a few minutes.",
    "fault": "The server at {place} failed, and not by your mistake{number}: try again; if it stays so, tell your course staff.",
    "not-polhode": "There is no polhode server at {place}, something else answered ({status}{page}): check the address.",
    "": "The server at {place} refused this ({status}).",
}
WITHOUT_PROBLEM = {401: "nobody", 404: "not-polhode", 413: "too-large", 500: "fault"} | dict.fromkeys(PASSING, "busy")


def refusal(answer: Answer, url: str, headers: Mapping[str, str]) -> Refused:
    """The exception for an error answer to a request with ``headers``, whose token is never repeated."""
    problem = _problem(answer)
    kind = str(problem.get("type", "")).rpartition(":")[2] if problem else WITHOUT_PROBLEM.get(answer.status, "")
    detail = _clean(str(problem.get("detail", "")), headers)
    passing = answer.status in PASSING
    refused = Refused(answer.status, kind, _sentence(answer, url, kind, detail), passing=passing)
    refused.wait_s = retry_after(answer.headers.get("retry-after", ""), datetime.now(UTC)) if passing else None
    return refused


def not_polhode(answer: Answer, url: str) -> Refused:
    """The exception for an answer that polhode does not give, whatever its status."""
    return Refused(answer.status, "not-polhode", _sentence(answer, url, "not-polhode", ""))


def retry_after(value: str, now: datetime) -> float | None:
    """Seconds that ``Retry-After`` asks for, given as a number or as a date; None if it tells neither."""
    if value.strip().isdecimal():
        return float(value)
    try:
        return max(0.0, (parsedate_to_datetime(value) - now).total_seconds())
    except (ValueError, TypeError):  # TypeError: a date without a zone
        return None


def is_page(answer: Answer) -> bool:
    """Whether the answer is a web page."""
    return "html" in answer.headers.get("content-type", "")


def _sentence(answer: Answer, url: str, kind: str, detail: str) -> str:
    key = "nobody" if answer.status == 401 else kind
    if detail and key not in SENTENCES:
        return detail[0].upper() + detail[1:].rstrip(".") + "."
    request = "".join(c for c in answer.headers.get("x-request-id", "")[:80] if c.isascii() and (c.isalnum() or c in "-_"))
    return SENTENCES.get(key, SENTENCES[""]).format(
        place=place(url),
        status=answer.status,
        detail=f" ({detail.rstrip('.')})" if detail else "",
        number=f" (request {request})" if request else "",
        page=", a web page, perhaps one to log in" if is_page(answer) else "",
    )


def _problem(answer: Answer) -> dict[str, Any]:
    if not answer.headers.get("content-type", "").startswith("application/problem+json"):
        return {}
    try:
        problem = json.loads(answer.body)
    except ValueError:
        return {}
    return problem if isinstance(problem, dict) else {}


def _clean(detail: str, headers: Mapping[str, str]) -> str:
    token = headers.get("authorization", "").rpartition(" ")[2]
    plain = "".join(c if c.isprintable() else " " for c in detail)
    return (plain.replace(token, "…") if len(token) >= SHORTEST_TOKEN else plain)[:LONGEST_DETAIL].strip()
