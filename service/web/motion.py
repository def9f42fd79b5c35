"""The motions of a report as data for the player: the student's attitude beside the exact one."""

import asyncio

from fastapi import APIRouter, Request, Response

from ecp.exercise import Motion
from ecp.outcome import Ending
from ecp.report import Report
from exercises.assignment import Assignment, assignments
from service.grading import motion, pictures
from service.web.pictures import Submission, kept_or_made
from service.web.problems import Problem
from service.web.roles import Looking

router = APIRouter()


@router.get("/submissions/{id}/motions/{name}.json")
async def show(person: Looking, stored: Submission, name: str, request: Request) -> Response:
    """A motion of the report, made when first asked for and kept."""
    assignment = assignments().get(stored.assignment)
    played = played_in(assignment, stored.report) if assignment and stored.report else {}
    asked = next((m for motions in played.values() for m in motions if m.name == name), None)
    if assignment is None or asked is None:
        raise Problem(404, "not-found", f"the report has no motion {name[:80]}")

    def made(packed: bytes) -> bytes:
        return motion.tell(assignment, asked, pictures.unpack(packed).get(asked.scene, {}), stored.seed)

    async def make(packed: bytes) -> bytes:
        return await asyncio.to_thread(made, packed)

    return await kept_or_made(request, stored, f"motions/{name}.json", "application/json", make)


def played_in(assignment: Assignment, report: Report) -> dict[str, list[Motion]]:
    """The motions that can be played, by the number of their exercise: of its exercises, those whose scene was finished."""
    told, finished = {e.number for e in report.exercises}, {e.scene for e in report.endings if e.ending is Ending.FINISHED}
    return {
        e.number: found
        for e in assignment.exercises
        if e.number in told and (found := [m for m in e.motions if m.scene in finished])
    }
