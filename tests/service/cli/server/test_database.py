"""polhode db, run in this process on a database."""

import pytest

from service.cli.__main__ import main
from tests.support.database import run, sql
from tests.support.submissions import hand_in


@pytest.fixture
def database(database_url, monkeypatch):
    monkeypatch.setenv("POLHODE_DATABASE_URL", database_url)
    run(database_url, lambda d: hand_in(d, "ann", {"2-energy": "✓"}))
    return database_url


def test_a_check_that_finds_something_exits_with_1_and_says_what(database, capsys):
    assert main(["db", "check"]) == 0 and "✗" not in capsys.readouterr().out
    sql(database, "INSERT INTO artefact VALUES ('0123', 'x')")
    assert main(["db", "check"]) == 1
    assert "✗  1 artefacts whose content does not match its hash" in capsys.readouterr().out


def test_a_backup_is_restored_only_where_nothing_is_lost(database, tmp_path, capsys):
    file = tmp_path / "b.dump"
    assert main(["db", "backup", str(file)]) == 0 and str(file) in capsys.readouterr().out
    assert main(["db", "restore", str(file)]) == 2 and "not empty" in capsys.readouterr().err
    assert main(["db", "restore", "--replace", str(file)]) == 0
    assert sql(database, "SELECT count(*) FROM submission") == [(1,)]
