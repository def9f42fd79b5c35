"""Gradescope's results.json, by its autograder specification.

Texts have the format "text", which Gradescope does not render. Gradescope sanitizes HTML by unpublished
rules, so a picture is a figure with a PNG as a data: URL and a caption that remains if the image is removed.
"""

import base64
from collections.abc import Iterator
from dataclasses import replace
from html import escape
from typing import Any

from exercises.authoring.assignments.assignment import Assignment
from polhode.judging.outcome import ExerciseReport, Outcome, Picture
from polhode.judging.verdict import Verdict
from polhode.report import failure_causes, report_overview
from polhode.report.report import Report
from service.formats import VISIBILITIES, VISIBLE
from service.formats.check_text import (
    NOTHING,
    SUBMITTED,
    NoVerdict,
    detail,
    not_attempted,
    one_line,
    sanitize,
)
from service.grading.graded_file import GradedFile, state
from service.grading.withholding import without_details

MOST_PICTURES = 4 << 20
"""Bytes of PNG per document. Gradescope documents no limit."""


def document(
    file: GradedFile, assignment: Assignment, *, max_score: float | None = None, hidden: str = VISIBLE
) -> dict[str, Any]:
    """Return the results of one file: a counted check is worth its points, or their share of ``max_score``.

    Hidden checks have the visibility ``hidden``. Each exercise that was not attempted is one failed test with
    all its points. Raises NoVerdict after a system fault and ValueError for an unknown visibility.
    """
    if hidden not in VISIBILITIES:
        raise ValueError(f"expected a visibility of {', '.join(VISIBILITIES)}, got {hidden!r}")
    if file.fault is not None:
        raise NoVerdict(file.fault)
    about = {"execution_time": round(file.seconds, 3), "output_format": "text", "stdout_visibility": "hidden"}
    if file.report is not None:
        return _graded(file, file.report, assignment, max_score, hidden) | about
    reason, most = sanitize(file.refused or ""), assignment.max_points() if max_score is None else max_score
    return {
        "score": 0,
        "output": reason,
        "tests": [_failed(SUBMITTED, reason) | {"score": 0, "max_score": most}],
    } | about


def _graded(
    file: GradedFile, report: Report, assignment: Assignment, max_score: float | None, hidden: str
) -> dict[str, Any]:
    missed = not_attempted(report, assignment)
    total = report.max_score + sum(missed.values())
    point = 1 if max_score is None else max_score / total if total else 0
    public = report if hidden == VISIBLE else without_details(report, assignment)
    tests = [
        test
        for pair in zip(report.exercises, public.exercises, strict=True)
        for test in _tests(_shown(*pair), report, point, hidden)
    ]
    tests += [_failed(name, name) | {"score": 0, "max_score": point * most} for name, most in missed.items()]
    if not report.max_score:
        tests.append(_failed(NOTHING, "no check could be scored"))
    made, provenance = {"assignment": report.assignment, "version": report.version}, report.provenance
    return {
        "score": report.score * point,
        "output": sanitize("\n\n".join(filter(None, [_causes(public, hidden), report.summary()]))),
        "tests": [*tests, *_figures(file, public)],
        "extra_data": made | {"seed": provenance.seed, "versions": provenance.versions},
    }


def _shown(whole: ExerciseReport, public: ExerciseReport) -> ExerciseReport:
    """Return an exercise with hidden outcomes in full and the others as in the ``public`` one."""
    pairs = zip(whole.outcomes, public.outcomes, strict=True)
    return replace(whole, outcomes=[one if one.hidden else shown for one, shown in pairs])


def _causes(report: Report, hidden: str) -> str:
    """Return the causes of what did not pass as text, of hidden checks only if these are visible."""
    shown = [
        replace(e, outcomes=[o for o in e.outcomes if hidden == VISIBLE or not o.hidden])
        for e in report.exercises
    ]
    return failure_causes.text(
        report_overview.overview(shown, report.scene_ends, report.suspect_lines).causes
    )


def _tests(exercise: ExerciseReport, report: Report, point: float, hidden: str) -> Iterator[dict[str, Any]]:
    """Yield a test for each check; a check that does not count has no points and no status."""
    for number, outcome in enumerate(exercise.outcomes, start=1):
        test: dict[str, Any] = {"name": one_line(outcome.label), "number": f"{exercise.number}.{number}"}
        if outcome.counted:
            passed = outcome.verdict is Verdict.PASS
            points = {"score": point * outcome.earned, "max_score": point * outcome.points}
            test |= points | {"status": "passed" if passed else "failed"}
        test |= {"output": detail(outcome, report), "output_format": "text", "tags": _tags(exercise, outcome)}
        test["visibility"] = hidden if outcome.hidden else VISIBLE
        test["extra_data"] = {
            "id": outcome.id,
            "verdict": outcome.verdict.value,
            "state": state(outcome, report.scene_ends),
        }
        yield test


def _tags(exercise: ExerciseReport, outcome: Outcome) -> list[str]:
    causes = outcome.diagnosis if outcome.verdict is not Verdict.PASS else []
    kinds = (
        ["hidden"] * outcome.hidden
        + ["no points"] * (not outcome.counted)
        + ["self-reported"] * outcome.self_reported
    )
    return [f"exercise {exercise.number}", *kinds, *(one_line(one.code) for one in causes)]


def _failed(name: str, output: str) -> dict[str, Any]:
    return {
        "name": name,
        "status": "failed",
        "output": output,
        "output_format": "text",
        "visibility": VISIBLE,
    }


def _figures(file: GradedFile, report: Report) -> Iterator[dict[str, Any]]:
    """Yield one test without points that shows the pictures, as far as they fit into MOST_PICTURES."""
    room, shown = MOST_PICTURES, []
    for picture in [*report.figures, *report.animations]:
        png = file.pictures.get(f"{picture.name}.png", b"")
        shown.append(_figure(picture, png if len(png) <= room else b""))
        room -= len(png) if len(png) <= room else 0
    if any(name.endswith(".png") for name in file.pictures):
        yield {
            "name": "Figures",
            "output": "\n".join(shown),
            "output_format": "html",
            "visibility": VISIBLE,
        }


def _figure(picture: Picture, png: bytes) -> str:
    """Return the picture as HTML, or its description if ``png`` is empty."""
    title, alt = escape(one_line(picture.title)), escape(one_line(picture.alt))
    data = base64.b64encode(png).decode()
    image = f'<img src="data:image/png;base64,{data}" alt="{alt}">' if png else f"<p>{alt}</p>"
    return f"<figure>{image}<figcaption>{title}</figcaption></figure>"
