"""Backup under load, restore into an empty database and across major versions, and a check that finds what is
wrong.
"""

import asyncio
from datetime import UTC, datetime
from pathlib import Path

import psycopg
import pytest

from service.store.course import deadlines, overrides, regrades
from service.store.people import tokens
from service.store.postgres import backup
from service.store.postgres.backup import BackupError
from service.store.postgres.os_user import DatabaseUnavailable
from service.store.postgres.server import EmbeddedPostgres, find_programs
from service.store.schema import migrate
from service.store.submissions.accepting import accept
from tests.support.database import new, run, sql
from tests.support.submissions import hand_in


@pytest.mark.slow
def test_a_backup_under_load_restores_to_a_consistent_state(database_url, empty_url, tmp_path):
    async def write_and_back_up(database):
        writing = asyncio.create_task(_keep_writing(database))
        await asyncio.sleep(0.3)
        await asyncio.to_thread(backup.backup, database_url, find_programs(), tmp_path / "b.dump")
        writing.cancel()

    async def _keep_writing(database):
        while True:
            await asyncio.gather(*(accept(database, new(f"p{k}")) for k in range(4)))

    run(database_url, write_and_back_up)
    backup.restore(empty_url, find_programs(), tmp_path / "b.dump")
    ((kept,),), ((all_,),) = (
        sql(url, "SELECT count(*) FROM submission") for url in (empty_url, database_url)
    )
    assert 0 < kept <= all_ and sql(empty_url, "SELECT count(*) FROM procrastinate_jobs") == [(kept,)]
    assert not any(backup.check(empty_url).values())
    assert run(empty_url, lambda d: accept(d, new()))  # and it works on


def test_a_backup_has_every_row_of_every_table(database_url, empty_url, tmp_path):
    async def fill(database):
        sent = await hand_in(database, "ann", {"2-energy": "✓", "2-momentum": "✗"})
        await overrides.give(database, sent, "prof", check="2-energy", points=0, reason="copied")
        await deadlines.extend(database, "rigid-body", "ann", datetime.now(UTC), reason="was ill", by="prof")
        await regrades.create(database, "rigid-body", sent, "prof", description="one submission")
        async with database.begin() as connection:
            await tokens.create(connection, "ann", label="test", scopes=["read"], seconds=1000.0)

    run(database_url, fill)
    backup.backup(database_url, find_programs(), tmp_path / "b.dump")
    backup.restore(empty_url, find_programs(), tmp_path / "b.dump")
    before, after = (rows_by_table(url) for url in (database_url, empty_url))
    assert before == after
    filled = {
        "submission",
        "result",
        "outcome",
        "artefact",
        "override",
        "extension",
        "regrade",
        "token",
        "audit",
        "secret",
    }
    assert all(before[table] > 0 for table in filled)


def rows_by_table(url):
    names = [name for (name,) in sql(url, "SELECT tablename FROM pg_tables WHERE schemaname = 'public'")]
    return {name: sql(url, f"SELECT count(*) FROM {name}")[0][0] for name in names}


def test_restoring_over_something_needs_to_be_asked_for(database_url, tmp_path):
    run(database_url, lambda d: accept(d, new()))
    backup.backup(database_url, find_programs(), tmp_path / "b.dump")
    run(database_url, lambda d: accept(d, new()))
    with pytest.raises(BackupError, match="not empty"):
        backup.restore(database_url, find_programs(), tmp_path / "b.dump")
    backup.restore(database_url, find_programs(), tmp_path / "b.dump", replace=True)
    assert sql(database_url, "SELECT count(*) FROM submission") == [(1,)]


def test_a_database_without_its_schema_is_restored(database_url, tmp_path):
    run(database_url, lambda d: accept(d, new()))
    backup.backup(database_url, find_programs(), tmp_path / "b.dump")
    sql(database_url, "DROP SCHEMA public CASCADE")
    backup.restore(database_url, find_programs(), tmp_path / "b.dump")
    assert sql(database_url, "SELECT count(*) FROM submission") == [(1,)] and not any(
        backup.check(database_url).values()
    )


def test_what_is_no_backup_is_refused(empty_url, tmp_path):
    (tmp_path / "b.dump").write_text("no dump")
    for name, words in (("none.dump", "no file"), ("b.dump", "pg_restore failed")):
        with pytest.raises(BackupError, match=words):
            backup.restore(empty_url, find_programs(), tmp_path / name)


def test_the_check_finds_what_does_not_fit(database_url):
    run(database_url, lambda d: hand_in(d, "ben", {"2-energy": "✓", "2-momentum": "✗", "2-motion": "⏱"}))
    assert not any(backup.check(database_url).values())
    sql(database_url, "DELETE FROM outcome WHERE state = 'pass'")
    run(database_url, lambda d: accept(d, new()))
    sql(
        database_url,
        "UPDATE grading SET preview = true WHERE NOT EXISTS (SELECT 1 FROM result WHERE grading_id = id)",
    )
    sql(database_url, "INSERT INTO artefact VALUES ('0123', 'x')")
    sql(database_url, "DELETE FROM procrastinate_jobs")
    sql(database_url, "UPDATE grading SET requested_at = now() - interval '1 hour'")
    found = {sentence for sentence, count in backup.check(database_url).items() if count}
    assert {s.split()[0] for s in found} == {"reports", "preview", "artefacts", "open"}


@pytest.mark.slow
def test_data_of_an_older_major_version_comes_over_by_a_dump(tmp_path):
    old = sorted(Path("/usr/lib/postgresql").glob("*/bin/pg_dump"))
    if not old or old[0].parts[-3] >= "18":
        pytest.skip("no older PostgreSQL here")
    before = EmbeddedPostgres(tmp_path / "data", programs=old[0].parent)
    before.start()
    migrate(before.url)
    run(before.url, lambda d: accept(d, new()))
    before.stop()
    with pytest.raises(
        DatabaseUnavailable, match=r"POLHODE_POSTGRES=/usr/lib/postgresql/\d+/bin polhode db backup"
    ):
        EmbeddedPostgres(tmp_path / "data").start()
    before.start()
    backup.backup(before.url, old[0].parent, tmp_path / "old.dump")
    before.stop()
    (tmp_path / "data" / "postgres").rename(tmp_path / "data" / "postgres.old")
    after = EmbeddedPostgres(tmp_path / "data")
    with after.new_cluster() as url:
        backup.restore(url, find_programs(), tmp_path / "old.dump")
    after.start()
    assert sql(after.url, "SELECT count(*) FROM submission") == [(1,)] and not any(
        backup.check(after.url).values()
    )
    after.stop()


def test_a_backup_that_breaks_off_destroys_nothing_and_nobody_else_can_read_it(database_url, tmp_path):
    run(database_url, lambda d: accept(d, new()))
    file = tmp_path / "b.dump"
    backup.backup(database_url, find_programs(), file)
    assert file.stat().st_mode & 0o777 == 0o600
    (tmp_path / "half.dump").write_bytes(file.read_bytes()[: file.stat().st_size * 2 // 3])
    with pytest.raises(BackupError):
        backup.restore(database_url, find_programs(), tmp_path / "half.dump", replace=True)
    assert sql(database_url, "SELECT count(*) FROM submission") == [(1,)] and not any(
        backup.check(database_url).values()
    )
    with pytest.raises(BackupError, match="is a folder"):
        backup.backup(database_url, find_programs(), tmp_path)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["b.dump", "half.dump"]


def test_a_server_goes_on_after_a_restore(database_url, tmp_path):
    """It has learnt ids that the restored database does not know."""
    file = tmp_path / "b.dump"

    async def back_in_time(database):
        await accept(database, new("ann"))
        await asyncio.to_thread(backup.backup, database_url, find_programs(), file)
        await accept(database, new("ben"))
        await asyncio.to_thread(backup.restore, database_url, find_programs(), file, replace=True)
        for name in ("ann", "ben"):
            for _ in range(3):  # a pooled connection may remember the tables that were there
                try:
                    await accept(database, new(name))
                    break
                except psycopg.Error:
                    continue

    run(database_url, back_in_time)
    assert sql(database_url, "SELECT name FROM person WHERE name IN ('ann', 'ben') ORDER BY name") == [
        ("ann",),
        ("ben",),
    ]
    assert sql(database_url, "SELECT count(*) FROM submission") == [(3,)]
