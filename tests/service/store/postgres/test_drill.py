"""A drill of the backup: everything comes back, also under load; what was lost is found."""

import asyncio

import psycopg
import pytest

from service.cli.__main__ import main
from service.store.postgres import drill
from service.store.postgres.server import find_programs
from service.store.submissions.accepting import accept
from tests.support.database import new, run, sql
from tests.support.submissions import hand_in


def test_the_contents_see_one_changed_value_and_no_order(database_url):
    run(database_url, lambda d: hand_in(d, "ann", {"2-energy": "✓"}))
    with psycopg.connect(database_url) as connection:
        before = drill.contents(connection)
    assert before["submission"].rows == 1 and before["outcome"].rows == 1
    sql(database_url, "UPDATE person SET email = 'ann@example.org'")
    with psycopg.connect(database_url) as connection:
        after = drill.contents(connection)
    assert [name for name in before if before[name] != after[name]] == ["person"]


@pytest.mark.slow
def test_a_drill_under_load_finds_every_row(database_url, tmp_path):
    async def write_meanwhile(database):
        async def keep_writing():
            while True:
                await asyncio.gather(*(accept(database, new(f"p{k}")) for k in range(4)))

        writing = asyncio.create_task(keep_writing())
        await asyncio.sleep(0.3)
        before = await asyncio.to_thread(drill.back_up, database_url, find_programs(), tmp_path / "b")
        writing.cancel()
        return before

    before = run(database_url, write_meanwhile)
    after, broken = drill.restore(tmp_path / "b", find_programs(), tmp_path / "data")
    assert before["submission"].rows > 0 and after == before and not any(broken.values())


@pytest.mark.slow
def test_the_command_exits_with_1_if_a_restored_row_differs(database_url, tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("POLHODE_DATABASE_URL", database_url)
    run(database_url, lambda d: hand_in(d, "ann", {"2-energy": "✓"}))
    assert main(["db", "drill"]) == 0
    assert "1 submissions" in (out := capsys.readouterr().out) and "every row is the same" in out
    before = drill.back_up(database_url, find_programs(), tmp_path / "b")
    changed = before | {"person": drill.Contents(5, "0"), "secret": before["secret"]._replace(hash="0")}
    monkeypatch.setattr(
        drill, "back_up", lambda url, programs, file: (drill.backup.backup(url, programs, file), changed)[1]
    )
    assert main(["db", "drill"]) == 1
    out = capsys.readouterr().out
    assert f"✗  person: {before['person'].rows} rows restored of 5\n" in out
    assert (
        f"✗  secret: {before['secret'].rows} rows restored of {before['secret'].rows}, with other values\n"
        in out
    )
    assert main(["db", "drill", str(tmp_path / "b")]) == 0
    assert main(["db", "drill", str(tmp_path / "none")]) == 2
