"""An older database with data in it becomes one of this version, once, whoever starts first."""

import threading
import uuid
from hashlib import sha256
from pathlib import Path

import pytest
from alembic import command
from alembic.config import Config
from procrastinate.schema import migrations_path
from sqlalchemy import create_engine

from service.store import database as migrating
from service.store import records
from service.store.database import driver_url, migrate
from service.store.postgres.backup import check
from tests.support.database import run, sql


@pytest.fixture
def old_url(empty_url):
    """A database as the first version left it: a graded submission, a faulted one and one that waits."""
    config = Config()
    config.set_main_option("script_location", str(Path(migrating.__file__).parent / "migrations"))
    engine = create_engine(driver_url(empty_url))
    with engine.begin() as connection:
        config.attributes["connection"] = connection
        command.upgrade(config, "0001")
    engine.dispose()
    insert = "INSERT INTO submission (id, assignment, source, filename, exercises, seed, fingerprint, idempotency_key) VALUES "
    for id, exercises, key in ((ONE, '["2"]', "k1"), (TWO, "null", "k2"), (THREE, None, None)):
        sql(empty_url, insert + "(%s, 'rigid-body', 'def ω(): 1', 'a.py', %s, 11, 'f', %s)", id, exercises, key)
    provenance = '{"seed": 11, "versions": {}, "walls": "tier B"}'
    about = '"label": "l", "detail": "d", "tolerance": {"reason": "r"}'
    checks = f'{{"id": "a", "verdict": "pass", "margin": 2.0, {about}}}, {{"id": "b", "verdict": "fail", "margin": 0.5, {about}}}'
    exercises = f'[{{"number": "2", "title": "t", "outcomes": [{checks}]}}]'
    told = f'"exercises": {exercises}, "score": 1.0, "max_score": 2.0'
    report = f'{{"assignment": "rigid-body", "version": "1", {told}, "provenance": {provenance}}}'
    sql(empty_url, "INSERT INTO result VALUES (%s, %s, NULL), (%s, 'null', 'ours')", ONE, report, TWO)
    for id, name, content in ((ONE, "arrays.npz", b"same"), (ONE, "figures/a.svg", b"other"), (TWO, "arrays.npz", b"same")):
        digest = sha256(content).hexdigest()
        sql(empty_url, "INSERT INTO artefact VALUES (%s, %s, %s, %s)", id, name, digest, content)
    return empty_url


ONE, TWO, THREE = (uuid.UUID(int=n) for n in (1, 2, 3))


def test_what_an_old_database_holds_is_there_afterwards(old_url):
    migrate(old_url)
    one, two, three = (run(old_url, lambda d, id=id: records.read(d, id)) for id in (ONE, TWO, THREE))
    assert (one.status, two.status, three.status) == ("graded", "faulted", "queued")
    assert one.exercises == ["2"] and two.exercises is None and one.seed == 11 and one.submission.source == "def ω(): 1"
    assert run(old_url, lambda d: records.find_artefact(d, one.attempt, "figures/a.svg"))[0] == b"other"
    assert sql(old_url, "SELECT count(*) FROM artefact") == [(2,)]
    assert not any(check(old_url).values())
    assert sql(old_url, "SELECT idempotency_key FROM submission ORDER BY id") == [("k1",), ("k2",), (None,)]


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
    assert not failures and migrate(old_url) == "0005"


def test_a_new_procrastinate_needs_a_revision_of_ours():
    """Our revision 0002 applies the schema of 3.10; when this fails, write one that runs the migrations after that."""
    assert max(p.name for p in Path(migrations_path).glob("*.sql"))[:5] <= "03.10"


def test_the_tables_are_as_the_code_declares_them(empty_url):
    from service.store.tables import metadata

    migrate(empty_url)
    found = sql(
        empty_url, "SELECT table_name, column_name, is_nullable FROM information_schema.columns WHERE table_schema = 'public'"
    )
    declared = {(t.name, c.name, "YES" if c.nullable else "NO") for t in metadata.tables.values() for c in t.columns}
    names = {t.name for t in metadata.tables.values()}
    assert {row for row in found if row[0] in names} == declared
