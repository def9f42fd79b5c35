"""The instructors' page of imported notebooks: how many of their lines count, and which of one do."""

from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import HTMLResponse, Response

from exercises.authoring.assignments.catalogue import assignments
from exercises.authoring.assignments.listing_index import line_counts
from exercises.authoring.importing.reported_lines import IN_WORDS, Status, reported_lines
from service.auth.roles import Staff
from service.http.errors import Problem
from service.http.templating import templates

router = APIRouter()
TO_DO = {
    Status.SHOWN: "add accept=True to the line in assignment.py, if a copied value may earn its points",
    Status.SELF_REPORTED: "do what the comment above the line in assignment.py says",
}
"""What makes a line of that status count."""


@router.get("/lines", response_class=HTMLResponse)
async def show_lines(
    request: Request, person: Staff, assignment: Annotated[str, Query(max_length=100)] = ""
) -> Response:
    """Show the imported notebooks with the numbers of their lines, or the lines of one."""
    if assignment and assignment not in assignments():
        raise Problem(404, "not-found", f"there is no assignment {assignment}: choose one of the list")
    rows = [(one, counts) for one in assignments().values() if (counts := line_counts(one))]
    exercises = assignments()[assignment].exercises if assignment else ()
    lines = [(exercise, line.declared) for exercise in exercises for line in reported_lines(exercise.checks)]
    context = {
        "rows": rows,
        "statuses": IN_WORDS,
        "to_do": TO_DO,
        "chosen": assignments().get(assignment),
        "lines": lines,
    }
    return templates.TemplateResponse(request, "notebook_lines.html", context)
