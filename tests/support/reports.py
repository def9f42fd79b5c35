"""Build reports for tests without grading anything: from outcomes, from the marks of a class table, from a
row of verdicts.
"""

from dataclasses import replace
from pathlib import Path

from exercises.authoring.assignments.catalogue import find
from polhode.judging.outcome import Diagnosis, Ended, ExerciseReport, Outcome, Picture, SceneEnd, Tolerance
from polhode.judging.verdict import Verdict
from polhode.report.report import Provenance, Report
from service.grading.graded_file import GradedFile

ASSIGNMENT = find("rigid-body")
PROVENANCE = Provenance(
    seed=7,
    versions={"polhode": "0.1.0", "python": "3.11.7"},
    isolation="process",
    phases_ms={"grade": 1000.0},
)
TOLERANCE = Tolerance(rtol=1e-6, atol=1e-9, reason="the notebook's own tolerance")
TRACEBACK = '  File "ann.py", line 3, in euler_eqs\n    return w / 0\nZeroDivisionError: division by zero\n'
SLIP = Diagnosis("sign-flipped", "ω̇₂ has the opposite sign: check (I₃ − I₁)", 1.0)
SLOW = SceneEnd("motion", Ended.TIMED_OUT, "your code did not finish within 2 s", "timeout")
UNMEASURED = {
    "⏱": SLOW.sentence,
    "!": "ValueError: no",
    "–": "your code stopped before this scene was played",
}
VERDICTS = {"+": Verdict.PASS, "-": Verdict.FAIL, "?": Verdict.UNMEASURED, ".": Verdict.UNMEASURED}


def outcome(id, verdict="pass", label="", **more):
    """Build one outcome; ``more`` sets or replaces any other field."""
    verdict = Verdict(verdict)
    detail = {
        Verdict.PASS: "got 1",
        Verdict.FAIL: "got 2 vs expected 1",
        Verdict.UNMEASURED: f"not measured: {more.get('cause')}",
    }
    fields = {
        "id": id,
        "label": label or id,
        "verdict": verdict,
        "detail": detail[verdict],
        "tolerance": TOLERANCE,
    }
    return Outcome(**(fields | more))


def report(*exercises, **more):
    """Build a report of exercises 1, 2, …, each a list of outcomes; ``more`` sets or replaces any field of
    the report. Without a ``total``, every exercise was attempted.
    """
    sections = [
        ExerciseReport(str(k), f"Title {k}", list(outcomes)) for k, outcomes in enumerate(exercises, start=1)
    ]
    fields = {"assignment": "rigid-body", "version": "1", "exercises": sections, "provenance": PROVENANCE}
    fields |= more
    made = sum(o.points for e in fields["exercises"] for o in e.outcomes if o.counted)
    return Report(**({"total": made} | fields))


def report_of_marks(marks, seed=7, **more):
    """Build a report of rigid-body whose checks have those ``marks``: ✓ ✗ ⏱ ! –, or (mark, margin[,
    diagnosis]), by check.
    """
    exercises = [
        ExerciseReport(
            e.number, e.title, [_marked(c, *_each(marks[c.id])) for c in e.checks if c.id in marks]
        )
        for e in ASSIGNMENT.exercises
    ]
    scene_ends = [SLOW, SceneEnd("cell 1", Ended.RAISED, "ValueError: no", "raises", "Traceback …")]
    provenance = replace(PROVENANCE, seed=seed)
    return report(
        exercises=[e for e in exercises if e.outcomes], scene_ends=scene_ends, provenance=provenance, **more
    )


def _each(marked):
    return marked if isinstance(marked, tuple) else (marked,)


def _marked(check, mark, margin=10.0, diagnosis=SLIP):
    verdict = {"✓": Verdict.PASS, "✗": Verdict.FAIL}.get(mark, Verdict.UNMEASURED)
    cause = UNMEASURED.get(mark)
    likely = [] if verdict is Verdict.PASS else [diagnosis]
    return outcome(
        check.id, verdict, check.label, cause=cause, margin=None if cause else margin, diagnosis=likely
    )


def report_of_verdicts(verdicts, **more):
    """Build a report whose checks c1, c2, … have the ``verdicts`` "+" pass, "-" fail, "?" unmeasured, "." not
    counted.
    """
    outcomes = [
        outcome(f"c{k}", VERDICTS[one], f"check {k}", counted=one != ".")
        for k, one in enumerate(verdicts, start=1)
    ]
    return report(**{"exercises": [ExerciseReport("2", "Euler", outcomes)]} | more)


def example():
    """Build a report that has everything once, in the words of a real one."""
    raised = "ZeroDivisionError: division by zero"
    first = [outcome("1-notebook", label="principal moments match the analytic box result")]
    slip = Diagnosis("sign-flipped", "ω̇₂ has the opposite sign", 1.0)
    stopped = Diagnosis("raises", raised, 1.0)
    failed = {
        "measured": 2.0,
        "expected": 1.0,
        "margin": 0.001,
        "where": "ω̇₂ at question 3",
        "diagnosis": [slip],
    }
    second = [
        outcome(
            "2-pointwise", Verdict.FAIL, "euler_eqs agrees with Euler's equations", **failed, hidden=True
        ),
        outcome(
            "2-energy",
            Verdict.UNMEASURED,
            "rotational energy conserved (torque-free)",
            cause=raised,
            diagnosis=[stopped],
        ),
        outcome(
            "2-drawn", Verdict.UNMEASURED, "what is drawn moves", cause="nothing to follow", counted=False
        ),
    ]
    scene_ends = [SceneEnd("motion", Ended.RAISED, raised, "raises", TRACEBACK)]
    figures = [Picture("omega", "2", "Angular velocity", "ω₁, ω₂ and ω₃ over time")]
    return report(first, second, scene_ends=scene_ends, figures=figures, total=3)


def graded_file(report, file="samples/ann.py", **more):
    """Build what ``polhode grade`` knows of a file that got this report."""
    source = "import x\n\ndef euler_eqs(t, w, I): return w / 0\n"
    return GradedFile(**({"file": Path(file), "report": report, "source": source} | more))
