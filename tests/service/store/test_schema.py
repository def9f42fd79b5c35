"""An empty database gets the tables, a full one the next revision, once, whoever starts first."""

import re
import shutil
import threading
from pathlib import Path

import psycopg
import pytest
from procrastinate.schema import migrations_path

from service.store import schema
from service.store.postgres import backup, drill
from service.store.postgres.server import find_programs
from service.store.schema import TABLES, WrongSchema, migrate
from tests.support.database import sql
from tests.support.waiting import wait_for

FILL = """
INSERT INTO person (name, full_name) VALUES ('ann', 'Ann');
INSERT INTO member SELECT c.id, p.id, 'student' FROM course c, person p WHERE p.name = 'ann';
INSERT INTO note (person_id, note, author) SELECT id, 'was ill', 'prof' FROM person WHERE name = 'ann';
INSERT INTO token (person_id, digest, prefix, label, scopes, expires_at)
    SELECT id, 'd', 'polhode_abcd', 'laptop', '{read}', now() FROM person WHERE name = 'ann';
INSERT INTO oidc_account (issuer, subject, person_id)
    SELECT 'https://id', 's-1', id FROM person WHERE name = 'ann';
INSERT INTO device_login (device_digest, user_code, label, expires_at)
    VALUES ('d', 'BCDF-GHJK', 'lab', now());
INSERT INTO assignment (course_id, slug, due_at, submission_limit)
    SELECT id, 'rigid-body', now(), 7 FROM course;
INSERT INTO assignment_version (assignment_id, version) SELECT id, '1' FROM assignment;
INSERT INTO extension (assignment_id, person_id, due_at, reason, given_by)
    SELECT a.id, p.id, now(), 'ill', 'prof' FROM assignment a, person p WHERE p.name = 'ann';
INSERT INTO submission (id, assignment_id, person_id, source, sha256, filename, fingerprint)
    SELECT gen_random_uuid(), a.id, p.id, 'x = 1', encode(sha256('x = 1'), 'hex'), 'a.py',
        'f' FROM assignment a, person p WHERE p.name = 'ann';
INSERT INTO regrade (assignment_id, description, requested_by)
    SELECT id, 'all of them', 'prof' FROM assignment;
INSERT INTO grading (id, submission_id, number, kind, seed, max_runs)
    SELECT gen_random_uuid(), id, 1, 'interactive', 11, 3 FROM submission;
INSERT INTO run (id, grading_id, worker, ended_at, end_reason)
    SELECT gen_random_uuid(), id, 'host/1', now(), 'finished' FROM grading;
INSERT INTO result (grading_id, run_id, report, score, max_score, version, isolation)
    SELECT grading_id, id, '{"score": 1, "total": 1}', 1, 1, '1', 'process' FROM run;
INSERT INTO outcome (grading_id, check_id, state, counted, margin, codes, causes, points, earned)
    SELECT id, 'a', 'pass', true, 2.0, '{}', '{}', 1, 1 FROM grading;
INSERT INTO artefact VALUES (encode(sha256('same'), 'hex'), 'same');
INSERT INTO grading_artefact SELECT id, 'arrays.npz', sha256 FROM grading, artefact;
INSERT INTO override (submission_id, check_id, points, reason, given_by)
    SELECT id, 'a', 0.5, 'half right', 'prof' FROM submission;
INSERT INTO regrade_request (submission_id, reason) SELECT id, 'the same number' FROM submission;
INSERT INTO source_comment (submission_id, cell, line, comment, author)
    SELECT id, 1, 1, 'why?', 'prof' FROM submission;
INSERT INTO worker (name, isolation) VALUES ('host/1', 'process');
INSERT INTO audit (actor, action, subject) VALUES ('prof', 'rules', 'rigid-body');
INSERT INTO procrastinate_jobs (queue_name, task_name, priority, args)
    SELECT 'grade', 'sweep', 1000, jsonb_build_object('attempt', id::text) FROM grading
"""
NEXT = '''"""Say of each result who recorded it: a revision for these tests."""

from alembic import op

revision = "0002"
down_revision = "0001"


def upgrade() -> None:
    op.execute("CREATE TABLE recorder (grading_id uuid PRIMARY KEY REFERENCES result, name text NOT NULL)")
    op.execute(
        "INSERT INTO recorder SELECT r.grading_id, run.worker FROM result r JOIN run ON run.id = r.run_id"
    )
'''


@pytest.fixture
def full_url(database_url):
    """A database with rows in every table."""
    sql(database_url, FILL)
    return database_url


@pytest.fixture
def next_version(tmp_path, monkeypatch):
    """The version after this one, which has one revision more."""
    folder = shutil.copytree(schema.MIGRATIONS, tmp_path / "migrations")
    (folder / "versions" / "0002_next.py").write_text(NEXT)
    monkeypatch.setattr(schema, "MIGRATIONS", folder)


def contents(url):
    """Number and hash of the rows of each table but Alembic's."""
    with psycopg.connect(url) as connection:
        found = drill.contents(connection)
    del found["alembic_version"]
    return found


def test_the_next_revision_keeps_every_row_of_every_table(full_url, next_version):
    before = contents(full_url)
    assert all(before[table].rows for table in (*TABLES, "procrastinate_jobs"))
    assert migrate(full_url) == "0002"
    after = contents(full_url)
    assert after.pop("recorder").rows == 1 and after == before
    assert not any(backup.check(full_url).values())


def test_a_backup_of_this_version_is_restored_by_the_next(full_url, empty_url, tmp_path, next_version):
    before = contents(full_url)
    backup.backup(full_url, find_programs(), tmp_path / "b.dump")
    backup.restore(empty_url, find_programs(), tmp_path / "b.dump")
    after = contents(empty_url)
    assert after.pop("recorder").rows == 1 and after == before


@pytest.mark.parametrize(
    "statement",
    [
        "UPDATE submission SET late = true",
        "UPDATE result SET score = 2",
        "UPDATE course SET late_penalty = 2",
        "UPDATE assignment SET scores_release = 'never'",
        "UPDATE assignment SET details_release = 'never'",
        "UPDATE override SET points = -1",
        "INSERT INTO override (submission_id, check_id, points, reason, given_by)"
        " SELECT id, 'a', 1, 'twice', 'prof' FROM submission",
        "INSERT INTO regrade_request (submission_id, reason) SELECT id, 'again' FROM submission",
        "UPDATE regrade_request SET status = 'declined'",  # without a date
        "UPDATE source_comment SET line = 0",
    ],
)
def test_tables_refuse_what_no_request_may_store(full_url, statement):
    with pytest.raises((psycopg.IntegrityError, psycopg.errors.RaiseException)):
        sql(full_url, statement)


def test_many_that_start_at_once_migrate_once(empty_url):
    failures = []

    def start():
        try:
            migrate(empty_url)
        except Exception as error:
            failures.append(error)

    threads = [threading.Thread(target=start) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failures and migrate(empty_url) == "0001"


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


def test_a_migration_that_is_cut_off_leaves_the_old_tables_and_is_repeated(full_url, next_version):
    """As when the database ends meanwhile: the connection is cut while a revision waits for a table."""
    failures = []

    def start():
        try:
            migrate(full_url)
        except psycopg.OperationalError as error:
            failures.append(error)

    waiting = (
        "SELECT pid FROM pg_locks WHERE NOT granted AND database = (SELECT oid FROM pg_database WHERE datname"
        " = current_database())"
    )
    before = _schema(full_url)
    with psycopg.connect(full_url) as writer:
        writer.execute("LOCK TABLE run")
        thread = threading.Thread(target=start)
        thread.start()
        ((pid,),) = wait_for(lambda: sql(full_url, waiting))
        sql(full_url, "SELECT pg_terminate_backend(%s)", pid)
        thread.join()
    assert failures and _schema(full_url) == before
    assert migrate(full_url) == "0002" and not any(backup.check(full_url).values())


def _schema(url):
    """Revision and columns of a database."""
    columns = (
        "SELECT table_name, column_name FROM information_schema.columns WHERE table_schema = 'public' ORDER"
        " BY 1, 2"
    )
    return sql(url, "SELECT version_num FROM alembic_version"), sql(url, columns)


def test_a_new_procrastinate_needs_a_revision_of_ours():
    """Our revision 0001 applies the schema of 3.10; when this fails, write one that runs the migrations after
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
