"""Rows for tests of exports: a class of five, each with something of their own."""

from datetime import UTC, datetime

from service.formats.grade_row import GradeRow

TITLE, CHECKS = "2.6 Rigid-Body Rotation", ("2-energy", "2-motion")


def row(student, points=None, **more):
    about = {
        "assignment": "rigid-body",
        "title": TITLE,
        "max_points": 2,
        "due_at": datetime(2026, 3, 1, 12, tzinfo=UTC),
    }
    sent = {
        "submission": f"00000000-0000-0000-0000-{len(student):012}",
        "submitted_at": datetime(2026, 2, 28, 23, 59, 58, 123456, UTC),
        "graded_at": datetime(2026, 3, 1, 0, 0, 1, tzinfo=UTC),
        "late": False,
        "status": "graded",
        "attempts": 1,
        "score": points,
        "counted": 2,
        "grader": "polhode 0.1.0, assignment version 1",
        "checks": {
            "2-energy": "pass" if points else "fail",
            "2-motion": "pass" if points == 2 else "timeout",
        },
        "worth": {"2-energy": 1, "2-motion": 1},
        "earned": {"2-energy": int(bool(points)), "2-motion": int(points == 2)},
    }
    return GradeRow(**about, student=student, points=points, **((sent if points is not None else {}) | more))


def known(student, full_name, number):
    return {"full_name": full_name, "email": f"{student}@uni.example", "student_id": number}


CLASS = [
    row("ada", 2, **known("ada", "Ada Lovelace", "00815")),
    row("ben", 1, late=True, attempts=5, **known("ben", "van Dyk, Ben", "00816")),
    row(
        "cho",
        1,
        score=0,
        overridden=True,
        given={"2-energy": 1},
        checks={"2-energy": "fail", "2-motion": "timeout"},
        earned={"2-energy": 0, "2-motion": 0},
    ),
    row("dora", **known("dora", "Dora Çelik", "00817")),
    row(
        "eve",
        status="faulted",
        submission="f",
        submitted_at=datetime(2026, 3, 1, 11, tzinfo=UTC),
        late=False,
        attempts=1,
    ),
]
