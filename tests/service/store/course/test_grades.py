"""Exports of a large class: how many queries they are, and how long they take."""

import json
import secrets

import psycopg

from exercises.authoring.assignments import catalogue
from service.store.course import grades
from service.store.database import Database
from tests.support.database import new_database, run

SLUG = "/assignments/rigid-body"


class Counting(Database):
    """Counts what it asks."""

    asked = 0

    async def rows(self, *query):
        self.asked += 1
        return await super().rows(*query)


def counted(url, action):
    async def count(_):
        async with Counting(url, "counting", connections=2) as database:
            found = await action(database)
            return database.asked, found

    return run(url, count)


BULK = """
INSERT INTO person (name, full_name) SELECT 's' || k, 'Student ' || k FROM generate_series(1, %(students)s) k;
INSERT INTO member (course_id, person_id, role) SELECT c.id, p.id, 'student' FROM course c, person p
  WHERE p.name ~ '^s[0-9]+$';
INSERT INTO submission (id, assignment_id, person_id, source, sha256, filename, fingerprint, submitted_at)
    SELECT gen_random_uuid(), x.id, p.id, 'x = ' || k, '', 'submission.py', '',
      now() + k * interval '1 minute'
    FROM assignment x, person p, generate_series(1, %(sent)s) k WHERE p.name ~ '^s[0-9]+$';
INSERT INTO grading (id, submission_id, number, kind, seed, max_runs)
    SELECT gen_random_uuid(), id, 1, 'interactive', 7, 3 FROM submission;
INSERT INTO result (grading_id, report, score, max_score, version) SELECT id, CAST(%(report)s AS jsonb), 5,
  10, '1' FROM grading;
INSERT INTO outcome (grading_id, check_id, state, counted, codes, causes, points, earned)
    SELECT a.id, '2-check' || k, CASE WHEN k %% 2 = 0 THEN 'pass' ELSE 'fail'
      END, true, '{}', '{}', 1, (k + 1) %% 2
    FROM grading a, generate_series(1, 10) k
"""


def class_of(postgres, students, sent):
    """The address of a database with a class that size, each report ten checks and 20 kB."""
    url = new_database(postgres.url, "polhode")
    run(url, Database.ping)
    report = {"provenance": {"versions": {"polhode": "0.1.0"}}, "stdout": secrets.token_hex(10_000)}
    with psycopg.connect(url, autocommit=True) as connection:
        for statement in BULK.split(";\n"):
            connection.execute(statement, {"students": students, "sent": sent, "report": json.dumps(report)})
    return url


async def batches(database):
    return [len(batch) async for batch in grades.submissions(database, "rigid-body")]


def test_there_is_no_query_per_student_and_none_per_submission(postgres):
    few, many = class_of(postgres, 2, 2), class_of(postgres, 40, 3)
    for slug, each in (("rigid-body", 1), (None, len(catalogue.assignments()))):
        (asked_few, rows_few), (asked_many, rows_many) = (
            counted(url, lambda d, slug=slug: grades.grades(d, slug)) for url in (few, many)
        )
        assert asked_few == asked_many == 1 and (len(rows_few), len(rows_many)) == (2 * each, 40 * each)
    assert counted(many, batches) == (6, [25, 25, 25, 25, 20])
