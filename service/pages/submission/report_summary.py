"""The head of a submission's page: points, a chip for each exercise, and whether the submission counts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from uuid import UUID

from exercises.authoring.assignments.assignment import Assignment
from polhode.judging.exercise import Motion
from polhode.judging.outcome import Picture
from polhode.report.report import Report
from service.store.database import Row
from service.store.submissions.records import SubmissionRecord


@dataclass(frozen=True)
class Chip:
    """An exercise with its points and its ``state``: "pass", "part" of the points, "fail", or "none" if it
    was not attempted.
    """

    number: str
    title: str
    state: str
    points: str = ""


@dataclass(frozen=True)
class Points:
    """The points that a page shows: ``shown`` out of ``most``, ``share`` of them, and ``bonus`` besides."""

    shown: float
    most: int
    bonus: str

    @property
    def share(self) -> float:
        """Return the share of the points, from 0 to 100."""
        return 100 * min(max(self.shown / self.most, 0.0), 1.0) if self.most else 0.0


@dataclass(frozen=True)
class Standing:
    """Whether a submission counts, in ``words``, and if another one does, its id and points."""

    words: str
    other: UUID | None = None
    points: float = 0


def chips(assignment: Assignment | None, report: Report) -> list[Chip]:
    """Return a chip for each exercise of the assignment, or of the report if the assignment is gone."""
    found = {}
    for section in report.overview().sections:
        for exercise in section.exercises:
            counted = [o for o in exercise.outcomes if o.counted]
            passed = all(o.verdict == "pass" for o in counted or exercise.outcomes)
            earned = sum(o.earned for o in counted)
            needed = [o for o in counted if not o.bonus]
            bonus = earned - sum(o.earned for o in needed)
            points = f"{earned - bonus}/{sum(o.points for o in needed)}" if needed else ""
            points += f" +{bonus}" if bonus else ""
            state = "pass" if passed else "part" if earned else "fail"
            found[exercise.number] = Chip(exercise.number, exercise.title, state, points)
    declared = {e.number: Chip(e.number, e.title, "none") for e in assignment.exercises} if assignment else {}
    return list((declared | found).values())


def points(assignment: Assignment | None, report: Report, stored: SubmissionRecord) -> Points:
    """Return the points after overrides and late penalty, with those of optional functions apart unless an
    override or a penalty mixed them.
    """
    most = assignment.max_points() if assignment else report.max_points or report.total
    bonus = assignment.bonus_points() if assignment else report.bonus_points or 0
    final = stored.final or 0
    if not bonus:
        return Points(final, most, "")
    if final != report.score:
        return Points(final, most, f", bonus included (at most {bonus})")
    return Points(final - report.bonus, most, f", +{report.bonus} of {bonus} bonus")


def standing(stored: SubmissionRecord, rows: Sequence[Row]) -> Standing | None:
    """Return whether the submission counts among the person's ``rows``, newest first; None if it has no
    points. The most points after the late penalty count; of equal ones, the newest.
    """
    graded = [row for row in rows if row.final is not None]
    if all(row.id != stored.id for row in graded):
        return None
    best = max(graded, key=lambda row: row.final)
    if best.id == stored.id:
        return Standing("this one counts")
    later = best.submitted_at > stored.submitted_at
    return Standing(f"{'a later' if later else 'an earlier'} one counts, with", best.id, best.final)


def beside(
    assignment: Assignment, report: Report, motions: Mapping[str, Sequence[Motion]]
) -> Motion | Picture | None:
    """Return the player, the animation or the figure that shows what fails first, None if none does: one of a
    scene of the checks that the first cause explains, else one of their exercises.
    """
    seen = report.overview()
    failed = seen.causes[0].outcomes() if seen.causes else [seen.unexplained] if seen.unexplained else []
    explained = {outcome.id for outcome in failed}
    numbers = [e.number for e in report.exercises if explained & {o.id for o in e.outcomes}]
    scenes = {scene for check in assignment.checks() if check.id in explained for scene in check.scenes}
    exercises = [assignment.exercise(number) for number in numbers]
    drawn = {f.name for e in exercises for f in e.figures if scenes & set(f.scenes)}
    drawn |= {a.name for e in exercises for a in e.animations if a.scene in scenes}
    pictures = [p for p in [*report.animations, *report.figures] if p.exercise in numbers]
    moving = [motion for number in numbers for motion in motions.get(number, [])]
    fitting: list[Motion | Picture] = [
        *(m for m in moving if m.scene in scenes),
        *(p for p in pictures if p.name in drawn),
    ]
    return next(iter([*fitting, *moving, *pictures]), None)
