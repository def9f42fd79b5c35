"""An older database with data in it becomes one of this version, once, whoever starts first."""

import re
import threading
import uuid
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path

import psycopg
import pytest
from alembic import command
from alembic.config import Config
from procrastinate.schema import migrations_path
from sqlalchemy import create_engine
from sqlalchemy.exc import OperationalError

from service.sandbox.result import Cancelled
from service.settings import Settings
from service.store import artefacts, history, queue_overview, records, regrades, runs, schema, sweeps, workers
from service.store.course import (
    audit,
    comments,
    course_settings,
    credentials,
    deadlines,
    gradebook,
    grades,
    notes,
    outcomes,
    overrides,
    people,
    regrade_requests,
    tokens,
)
from service.store.postgres.backup import check
from service.store.schema import TABLES, WrongSchema, driver_url, migrate
from service.workers.worker import Worker
from tests.support.database import run, sql
from tests.support.grader import NoSandbox
from tests.support.waiting import wait_for


def upgrade(url, revision):
    """Bring a database to that revision."""
    config = Config()
    config.set_main_option("script_location", str(Path(schema.__file__).parent / "migrations"))
    engine = create_engine(driver_url(url))
    with engine.begin() as connection:
        config.attributes["connection"] = connection
        command.upgrade(config, revision)
    engine.dispose()


@pytest.fixture
def old_url(empty_url):
    """A database as the first version left it: a graded submission, a faulted one and one that waits."""
    upgrade(empty_url, "0001")
    insert = (
        "INSERT INTO submission (id, assignment, source, filename, exercises, seed, fingerprint,"
        " idempotency_key) VALUES "
    )
    for id, exercises, key in ((ONE, '["2"]', "k1"), (TWO, "null", "k2"), (THREE, None, None)):
        sql(
            empty_url,
            insert + "(%s, 'rigid-body', 'def ω(): 1', 'a.py', %s, 11, 'f', %s)",
            id,
            exercises,
            key,
        )
    provenance = '{"seed": 11, "versions": {}, "walls": "tier B"}'
    about = '"label": "l", "detail": "d", "tolerance": {"reason": "r"}'
    checks = (
        f'{{"id": "a", "verdict": "pass", "margin": 2.0, {about}}}, {{"id": "b", "verdict": "fail", "margin":'
        f" 0.5, {about}}}"
    )
    exercises = f'[{{"number": "2", "title": "t", "outcomes": [{checks}]}}]'
    told = f'"exercises": {exercises}, "score": 1.0, "max_score": 2.0'
    report = f'{{"assignment": "rigid-body", "version": "1", {told}, "provenance": {provenance}}}'
    sql(empty_url, "INSERT INTO result VALUES (%s, %s, NULL), (%s, 'null', 'ours')", ONE, report, TWO)
    for id, name, content in (
        (ONE, "arrays.npz", b"same"),
        (ONE, "figures/a.svg", b"other"),
        (TWO, "arrays.npz", b"same"),
    ):
        digest = sha256(content).hexdigest()
        sql(empty_url, "INSERT INTO artefact VALUES (%s, %s, %s, %s)", id, name, digest, content)
    return empty_url


ONE, TWO, THREE = (uuid.UUID(int=n) for n in (1, 2, 3))


def test_what_an_old_database_holds_is_there_afterwards(old_url):
    migrate(old_url)
    one, two, three = (run(old_url, lambda d, id=id: records.read(d, id)) for id in (ONE, TWO, THREE))
    assert (one.status, two.status, three.status) == ("graded", "faulted", "queued")
    assert (
        one.exercises == ["2"]
        and two.exercises is None
        and one.seed == 11
        and one.submission.source == "def ω(): 1"
    )
    assert run(old_url, lambda d: artefacts.find_artefact(d, one.grading, "figures/a.svg"))[0] == b"other"
    assert sql(old_url, "SELECT count(*) FROM artefact") == [(2,)]
    assert not any(check(old_url).values())
    assert sql(old_url, "SELECT check_id, points, earned FROM outcome ORDER BY 1") == [
        ("a", 1, 1),
        ("b", 1, 0),
    ]
    assert (one.report.score, one.report.max_score, one.report.outcomes()[0].points) == (1, 2, 1)
    assert sql(old_url, "SELECT idempotency_key FROM submission ORDER BY id") == [("k1",), ("k2",), (None,)]


TABLES_0005 = {
    "artefact", "assignment", "assignment_version", "attempt", "audit", "course", "extension", "kept",
    "login", "member", "outcome",
    "override", "person", "regrade", "result", "run", "secret", "sign_in", "submission", "token", "worker",
    "procrastinate_jobs",
}  # fmt: skip
RENAMED = {
    "attempt": "grading",
    "kept": "grading_artefact",
    "login": "device_login",
    "sign_in": "oidc_account",
}
FIRST, PREVIEW, RUN, REGRADE = (uuid.UUID(int=n) for n in (11, 12, 13, 14))
AT = datetime(2026, 1, 2, 3, 4, 5, tzinfo=UTC)


@pytest.fixture
def full_url(empty_url):
    """A database as revision 0005 left it, with rows in every table: a graded submission and its regrade that
    waits.
    """
    upgrade(empty_url, "0005")
    ids = dict(
        zip(
            ("one", "first", "preview", "run", "regrade"),
            map(str, (ONE, FIRST, PREVIEW, RUN, REGRADE)),
            strict=True,
        )
    )
    values = ids | {"at": AT, "digest": sha256(b"same").hexdigest(), "device": sha256(b"device").hexdigest()}
    values["report"] = REPORT
    with psycopg.connect(empty_url) as connection:
        for statement in FILL_0005.strip().split(";"):
            connection.execute(statement, values)
    return empty_url


REPORT = (
    '{"assignment": "rigid-body", "version": "1", "score": 1.0, "max_score": 1.0, "provenance": {"seed": 11,'
    ' "versions": {}, "walls": "tier B"}, "exercises": [{"number": "2", "title": "t", "outcomes": [{"id":'
    ' "a", "verdict": "pass", "margin": 2.0, "label": "l", "detail": "d", "tolerance": {"reason": "r"}}]}]}'
)

FILL_0005 = """
INSERT INTO person (name, full_name) VALUES ('ann', 'Ann');
INSERT INTO member SELECT c.id, p.id, 'student' FROM course c, person p WHERE p.name = 'ann';
INSERT INTO token (person_id, digest, start, label, scopes, expires_at)
    SELECT id, 'd', 'polhode_abcd', 'laptop', '{read}', now() + interval '1 day' FROM person
      WHERE name = 'ann';
INSERT INTO sign_in (issuer, subject, person_id) SELECT 'https://id', 's-1', id FROM person
  WHERE name = 'ann';
INSERT INTO login (device_digest, user_code, label, expires_at)
  VALUES (%(device)s, 'BCDF-GHJK', 'lab', now() + interval '1 day');
INSERT INTO assignment (course_id, slug, due_at, grace_s, most_submissions) SELECT id, 'rigid-body', %(at)s,
  60, 7 FROM course;
INSERT INTO assignment_version (assignment_id, version) SELECT id, '1' FROM assignment;
INSERT INTO extension (assignment_id, person_id, due_at, reason, given_by)
    SELECT a.id, p.id, %(at)s, 'ill', 'prof' FROM assignment a, person p WHERE p.name = 'ann';
INSERT INTO submission (id, assignment_id, person_id, source, sha256, filename, fingerprint)
    SELECT %(one)s, a.id, p.id, 'x = 1', encode(sha256('x = 1'), 'hex'), 'a.py', 'f'
    FROM assignment a, person p WHERE p.name = 'ann';
INSERT INTO regrade (id, assignment_id, told, asked_by, asked_at)
    SELECT %(regrade)s, id, 'all of them', 'prof', %(at)s FROM assignment;
INSERT INTO attempt (id, submission_id, number, kind, seed, most_runs)
  VALUES (%(first)s, %(one)s, 1, 'interactive', 11, 3);
INSERT INTO attempt (id, submission_id, number, kind, seed, most_runs, regrade_id, held)
    VALUES (%(preview)s, %(one)s, 2, 'regrade', 11, 3, %(regrade)s, true);
INSERT INTO run (id, attempt_id, worker, beat_at, ended_at, ending)
    VALUES (%(run)s, %(first)s, 'host/1', %(at)s, %(at)s, 'finished');
INSERT INTO result (attempt_id, run_id, report, score, max_score, version, walls)
    VALUES (%(first)s, %(run)s, %(report)s, 1, 1, '1', 'tier B');
INSERT INTO outcome (attempt_id, check_id, state, counted, margin, codes, causes)
    VALUES (%(first)s, 'a', 'pass', true, 2.0, '{}', '{}');
INSERT INTO override (submission_id, check_id, points, reason, given_by)
  VALUES (%(one)s, 'a', 0, 'no', 'prof');
INSERT INTO artefact VALUES (%(digest)s, 'same');
INSERT INTO kept VALUES (%(first)s, 'arrays.npz', %(digest)s), (%(first)s, 'sweep.json', %(digest)s);
INSERT INTO worker (name, walls, refusal, zygotes)
  VALUES ('host/1', 'tier B', NULL, 4), ('host/2', NULL, 'no namespaces', 0);
INSERT INTO audit (who, action, subject) VALUES ('prof', 'rules', 'rigid-body');
INSERT INTO procrastinate_jobs (queue_name, task_name, priority, args)
    VALUES ('grade', 'grade', 1000, jsonb_build_object('attempt', %(preview)s::text))
"""


def _counts(url, tables):
    return {table: sql(url, f'SELECT count(*) FROM "{table}"')[0][0] for table in tables}


def test_renaming_keeps_every_row_and_the_store_reads_them(full_url):
    before = _counts(full_url, TABLES_0005)
    assert all(before.values()), "rows in every table"
    assert migrate(full_url) == "0011"
    assert _counts(full_url, {RENAMED.get(t, t) for t in TABLES_0005}) == {
        RENAMED.get(t, t): n for t, n in before.items()
    }
    assert not any(check(full_url).values())

    def read(action):
        return run(full_url, action)

    stored = read(lambda d: records.read(d, ONE))
    assert (stored.status, stored.grading, stored.points, stored.report.score) == ("graded", FIRST, 0, 1)
    assert [(g.number, g.preview, g.worker) for g in read(lambda d: history.gradings(d, ONE))] == [
        (1, False, "host/1"),
        (2, True, None),
    ]
    (regrade,) = read(lambda d: regrades.of_assignment(d, "rigid-body"))
    assert (regrade.description, regrade.requested_by, regrade.requested_at) == ("all of them", "prof", AT)
    assert [row.finished for row in read(lambda d: regrades.score_changes(d, REGRADE))] == [False]
    assert read(lambda d: artefacts.find_artefact(d, FIRST, "arrays.npz"))[0] == b"same"
    (entry,) = read(audit.entries)
    assert (entry.actor, entry.action) == ("prof", "rules")
    assert [t.prefix for t in read(lambda d: tokens.all_of(d, "ann"))] == ["polhode_abcd"]
    assert (
        read(lambda d: tokens.find_login(d, "bcdf-ghjk")) == "lab"
        and read(lambda d: tokens.collect_login(d, "device", 1)) is None
    )
    assert (
        read(lambda d: credentials.about(d, "ann")).issuer == "https://id"
        and read(lambda d: people.role(d, "ann")) == "student"
    )
    assert [o.points for o in read(lambda d: overrides.of_submission(d, ONE))] == [0]
    assert [e.reason for e in read(lambda d: deadlines.extensions(d, "rigid-body"))] == ["ill"]
    assert read(lambda d: gradebook.rules(d, "rigid-body")).submission_limit == 7
    (student,) = read(lambda d: gradebook.students(d, "rigid-body"))
    assert (student.grading, student.submissions) == (FIRST, 1)
    assert read(lambda d: outcomes.by_student(d, [FIRST]))[FIRST]["a"].endswith("*")
    assert read(lambda d: sweeps.count(d, [student])) == (1, 0)
    assert [row.attempts for row in read(lambda d: grades.grades(d, "rigid-body"))] == [1]
    queue = read(queue_overview.snapshot)
    assert [(row.grading, row.preview) for row in queue.places] == [(PREVIEW, True)]
    assert [(w.isolation, w.unavailable_reason, w.zygote_restarts) for w in queue.workers] == [
        ("tier B", None, 4),
        (None, "no namespaces", 0),
    ]
    assert sql(full_url, "SELECT end_reason, heartbeat_at FROM run") == [("finished", AT)]
    assert sql(full_url, "SELECT isolation FROM result") == [("tier B",)]


def test_feedback_on_a_submission_of_an_older_database(full_url):
    migrate(full_url)
    asked = run(full_url, lambda d: regrade_requests.request(d, ONE, "ann", "the same number"))
    assert asked in run(full_url, lambda d: regrade_requests.of_submission(d, ONE))
    noted = run(full_url, lambda d: comments.write(d, ONE, "prof", cell=1, line=1, comment="why?"))
    assert run(full_url, lambda d: comments.of_submission(d, ONE)) == [noted]
    for query in (
        "INSERT INTO regrade_request (submission_id, reason) VALUES (%s, 'again')",
        (
            "INSERT INTO regrade_request (submission_id, reason, status) VALUES (%s, 'without a date',"
            " 'declined')"
        ),
        (
            "INSERT INTO source_comment (submission_id, cell, line, comment, author) VALUES (%s, 1, 0, 'c',"
            " 'prof')"
        ),
    ):
        with pytest.raises(psycopg.IntegrityError):
            sql(full_url, query, ONE)


def test_settings_of_an_older_database_change_nothing(full_url):
    """Scores are released and nobody loses points; overrides keep theirs, and may be fractions."""
    given = sql(full_url, "SELECT id, points FROM override ORDER BY id")
    migrate(full_url)
    stored = run(full_url, lambda d: records.read(d, ONE))
    assert (stored.scores_released, stored.details_released, stored.penalty) == (True, True, 0)
    assert run(full_url, course_settings.read) == course_settings.CourseSettings("UTC", 0.0, 1.0)
    assert sql(full_url, "SELECT id, points FROM override ORDER BY id") == given
    sql(full_url, "UPDATE override SET points = 0.25")
    run(full_url, lambda d: notes.write(d, "ann", "was ill", "prof"))
    assert [n.note for n in run(full_url, lambda d: notes.of_person(d, "ann"))] == ["was ill"]
    for query in (
        "UPDATE course SET late_penalty = 2",
        "UPDATE assignment SET scores_release = 'never'",
        "UPDATE assignment SET details_release = 'never'",
    ):
        with pytest.raises(psycopg.IntegrityError):
            sql(full_url, query)


def test_a_job_queued_before_the_renaming_is_graded_after_it(full_url):
    migrate(full_url)
    ((arguments,),) = sql(full_url, "SELECT args FROM procrastinate_jobs")
    settings = Settings(database_url=full_url)
    seen = []

    async def grade(database):
        worker = Worker(settings, "w")
        worker._grader = NoSandbox()
        worker._call = lambda function, *args: seen.append(args[1]) or _cancelled()
        await worker._grade(**arguments)
        await worker._database.close()

    run(full_url, grade)
    assert seen == ["rigid-body"] and sql(
        full_url, "SELECT end_reason FROM run WHERE grading_id = %s", PREVIEW
    ) == [("superseded",)]
    assert run(full_url, lambda d: runs.claim(d, PREVIEW, uuid.uuid4(), "w")) is not None
    assert run(full_url, workers.sweep) == []


async def _cancelled():
    raise Cancelled


def test_the_index_of_a_killed_prune_gives_way_to_that_of_the_schema(full_url):
    upgrade(full_url, "0010")
    sql(full_url, "CREATE INDEX prune_artefacts ON grading_artefact (sha256)")
    migrate(full_url)
    found = sql(
        full_url,
        "SELECT indexname FROM pg_indexes WHERE tablename = 'grading_artefact' AND indexdef LIKE"
        " '%%(sha256)'",
    )
    assert found == [("grading_artefact_sha256",)]


def test_no_constraint_or_index_keeps_an_old_name(full_url):
    migrate(full_url)
    rows = sql(
        full_url,
        "SELECT conname FROM pg_constraint UNION SELECT indexname FROM pg_indexes WHERE schemaname ="
        " 'public'",
    )
    names = {name for (name,) in rows}
    old = re.compile(
        r"(^|_)(attempt|attempt_id|kept|sign_in|beat_at|held|told|asked_by|most_runs|refusal|walls)(_|$)|^login_"
    )
    assert not [name for name in names if old.search(name)]
    assert {
        "token_person", "submission_person_assignment", "submission_submitted_at", "grading_regrade",
        "ix_run_grading_id",
        "run_open", "override_in_force", "regrade_request_open", "regrade_request_submission",
        "source_comment_submission",
        "grading_artefact_sha256",
    } <= names  # fmt: skip


def test_many_that_start_at_once_migrate_once(old_url):
    failures = []

    def start():
        try:
            migrate(old_url)
        except Exception as error:
            failures.append(error)

    threads = [threading.Thread(target=start) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failures and migrate(old_url) == "0011"


def test_tables_of_a_later_version_are_refused_in_a_sentence(database_url):
    sql(database_url, "UPDATE alembic_version SET version_num = '9999'")
    with pytest.raises(
        WrongSchema, match=r"revision 9999.*up to \d{4}: install the later version.*polhode db restore"
    ):
        migrate(database_url)
    assert sql(database_url, "SELECT version_num FROM alembic_version") == [("9999",)]


def test_a_database_that_lost_tables_does_not_become_an_empty_course(empty_url):
    head = migrate(empty_url)
    sql(empty_url, "DROP TABLE submission CASCADE")
    with pytest.raises(WrongSchema, match=r"missing \(submission\): restore a backup"):
        migrate(empty_url)
    sql(empty_url, "DROP TABLE alembic_version")
    with pytest.raises(WrongSchema, match="alembic_version"):
        migrate(empty_url)
    sql(empty_url, "DROP SCHEMA public CASCADE")
    sql(empty_url, "CREATE SCHEMA public")
    with pytest.raises(WrongSchema, match="is empty, and its comment says that it had tables"):
        migrate(empty_url)
    assert sql(empty_url, "SELECT count(*) FROM pg_tables WHERE schemaname = 'public'") == [(0,)]
    name = empty_url.split("/")[3].split("?")[0]
    sql(empty_url, f"COMMENT ON DATABASE {name} IS NULL")
    assert migrate(empty_url) == head


def test_a_comment_of_the_operator_stays(empty_url):
    name = empty_url.split("/")[3].split("?")[0]
    sql(empty_url, f"COMMENT ON DATABASE {name} IS 'ours'")
    migrate(empty_url)
    comment = "SELECT shobj_description(oid, 'pg_database') FROM pg_database WHERE datname = %s"
    assert sql(empty_url, comment, name) == [("ours",)]


def test_a_migration_that_is_cut_off_leaves_the_old_tables_and_is_repeated(old_url):
    """As when the database ends meanwhile: the connection is cut while a revision waits for a table."""
    failures = []

    def start():
        try:
            migrate(old_url)
        except OperationalError as error:
            failures.append(error)

    waiting = (
        "SELECT pid FROM pg_locks WHERE NOT granted AND database = (SELECT oid FROM pg_database WHERE datname"
        " = current_database())"
    )
    before = _schema(old_url)
    with psycopg.connect(old_url) as reader:
        reader.execute("SELECT FROM result")
        thread = threading.Thread(target=start)
        thread.start()
        ((pid,),) = wait_for(lambda: sql(old_url, waiting))
        sql(old_url, "SELECT pg_terminate_backend(%s)", pid)
        thread.join()
    assert failures and _schema(old_url) == before
    assert migrate(old_url) == "0011" and not any(check(old_url).values())


def _schema(url):
    """Revision and columns of a database."""
    columns = (
        "SELECT table_name, column_name FROM information_schema.columns WHERE table_schema = 'public' ORDER"
        " BY 1, 2"
    )
    return sql(url, "SELECT version_num FROM alembic_version"), sql(url, columns)


def test_a_new_procrastinate_needs_a_revision_of_ours():
    """Our revision 0002 applies the schema of 3.10; when this fails, write one that runs the migrations after
    that.
    """
    assert max(p.name for p in Path(migrations_path).glob("*.sql"))[:5] <= "03.10"


def test_the_tables_are_as_the_docs_list_them(empty_url):
    migrate(empty_url)
    found = sql(
        empty_url,
        "SELECT table_name, column_name, is_nullable FROM information_schema.columns WHERE table_schema ="
        " 'public'",
    )
    docs = Path(schema.__file__).parents[2] / "docs/database.md"
    listed = re.findall(r"^\| `(\w+)` \| (.*) \|$", docs.read_text(), re.MULTILINE)
    declared = {
        (table, name, "YES" if null else "NO")
        for table, columns in listed
        for name, null in re.findall(r"`(\w+)(\??)`", columns)
    }
    assert {row for row in found if row[0] in TABLES} == declared
    others = {table for table, _, _ in found} - set(TABLES)
    assert all(name == "alembic_version" or name.startswith("procrastinate_") for name in others)
