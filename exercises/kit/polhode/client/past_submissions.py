"""``polhode.submissions``: the student's submissions to an assignment, and what changed from one to the
next.
"""

from dataclasses import dataclass
from datetime import datetime
from html import escape
from typing import Any

from polhode.client import course
from polhode.client.tokens import authorization
from polhode.client.transport.http import CONTACT_S, call
from polhode.report.report import out_of
from polhode.report.report_style import fragment


@dataclass(frozen=True, repr=False)
class Submissions:
    """A student's submissions to an assignment, newest first, and the ids of the best and the latest one.

    ``submissions`` are the objects of the server's JSON answer. ``address`` is the address of the
    assignment's page. ``out_of`` are the assignment's points, as in a report.
    """

    assignment: str
    submissions: list[dict[str, Any]]
    best: str | None
    last: str | None
    address: str
    out_of: str

    def __len__(self) -> int:
        return len(self.submissions)

    def __repr__(self) -> str:
        if not self.submissions:
            return "no submissions yet"
        return "\n".join("  ".join(row) for row in self._rows())

    def _repr_html_(self) -> str:
        if not self.submissions:
            return "no submissions yet"
        cells = [f"<tr><td>{'</td><td>'.join(map(escape, row))}</td></tr>" for row in self._rows()]
        head = "<tr><th>submitted</th><th>points</th><th></th><th>changes since the previous one</th></tr>"
        link = (
            f'<a href="{escape(self.address, quote=True)}" target="_blank" rel="noopener">View on the'
            " server</a>"
        )
        return fragment(f"<table><thead>{head}</thead><tbody>{''.join(cells)}</tbody></table>{link}")

    def _rows(self) -> list[tuple[str, ...]]:
        return [self._row(one) for one in self.submissions]

    def _row(self, one: dict[str, Any]) -> tuple[str, ...]:
        at = datetime.fromisoformat(one["submitted_at"]).astimezone()
        when = f"{at:%Y-%m-%d %H:%M}{' late' if one['late'] else ''}"
        graded = "" if one["points"] == one["score"] else f" (graded {one['score']})"
        score = one["status"] if one["score"] is None else f"{one['points']} of {self.out_of}{graded}"
        note = ", ".join(word for word, id in (("best", self.best), ("latest", self.last)) if id == one["id"])
        return when, score, note, one["changed"]["summary"] if one["changed"] else ""


def submissions(server: str | None = None, assignment: str | None = None) -> Submissions:
    """Return your submissions to an assignment: times, points, the best and the latest one, and what changed.

    ``server`` and ``assignment`` default to those of ``polhode.connect``. Raises UnknownCourse if one of them
    is not known, Unreachable if the server does not answer, and HTTPError if it refuses, for example because
    you are not logged in.
    """
    slug = course.assignment(assignment)
    where = course.server(server, slug)
    found = own(where, slug)
    return Submissions(
        found["assignment"],
        found["submissions"],
        found["best"],
        found["last"],
        f"{where}/assignments/{slug}",
        out_of(found["max_points"], found["bonus_points"]),
    )


def own(server: str, slug: str) -> dict[str, Any]:
    """Return the server's list of one's submissions to an assignment."""
    address = f"{server}/v1/assignments/{slug}/submissions"
    found: dict[str, Any] = call("GET", address, headers=authorization(server), patience=CONTACT_S).json()
    return found
