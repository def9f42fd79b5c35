"""Commands of an operator: one sentence and an exit code where something is wrong."""

import os
import subprocess
import sys
from importlib import metadata

import pytest

from tests.support.command_line import polhode
from tests.support.database import sql

NOWHERE = {"POLHODE_DATA": "/tmp/polhode-nowhere"}
WRONG = [
    (["queue"], NOWHERE, "no database in /tmp/polhode-nowhere"),
    (["db", "backup", "x.dump"], NOWHERE, "no database in /tmp/polhode-nowhere"),
    (["serve"], {"POLHODE_PORT": "abc"}, "POLHODE_PORT: "),
    (["serve"], {"POLHODE_DATABASE_URL": "mysql://root:secret@host/db"}, "POLHODE_DATABASE_URL: "),
    (["queue"], {"POLHODE_DATABASE_URL": "postgresql://u:secret@127.0.0.1:1/db"}, "connection"),
    (["queue"], {"POLHODE_SUBMISSION_KIB": "9999"}, "polhode: POLHODE_UPLOAD_MIB must hold at least 6 times"),
    (["regrade"], {}, "give exactly one of ids"),
    (["regrade", "--all", "--faults"], {}, "give exactly one of ids"),
    (["assign", "rigid-body", "--grace", "nan"], {}, "expected 0 to"),
    (["assign", "rigid-body", "--most", "0"], {}, "a number from 1"),
    (["assign", "rigid-body", "--due", "tomorrow"], {}, "a time such as"),
    (["assign", "rigid-body", "--due", "2026-12-01T12:00"], {}, "time zone"),
    (["export", "gradescope", "--out", "x.zip", "--assignment", "nope"], {}, "no assignment nope"),
    (
        ["export", "gradescope", "--out", "x.zip", "--assignment", "rigid-body", "--exercise", "9"],
        {},
        "no exercise 9",
    ),
    (["roster", "--tokens", "t.csv"], {}, "apply to an import: give the file ROSTER.csv too"),
    (["roster", "--role", "x=student"], {}, "apply to an import: give the file ROSTER.csv too"),
    (["roster", "--days", "9"], {}, "apply to an import: give the file ROSTER.csv too"),
    (["roster", "people.csv", "--days", "9"], {}, "give the file --tokens TOKENS.csv too"),
    (["mutants", "--most", "0"], {}, "expected at least 1"),
    (["worker", "--slots", "0"], {}, "expected at least 1"),
]
# These open logs and handle signals first, which is for a process of their own.
WRONG_FOR_LONG = [
    (["worker"], NOWHERE, "or set POLHODE_DATABASE_URL"),
    (["worker"], NOWHERE | {"POLHODE_WORKERS": "0"}, "set POLHODE_WORKERS or --slots to at least 1"),
    (["serve", "--host", "203.0.113.1"], NOWHERE, "203.0.113.1 port 8000"),
]


def ids(cases):
    return [" ".join(arguments) for arguments, _, _ in cases]


def assert_one_sentence(ended, words):
    assert ended.returncode == 2 and words in ended.stderr, ended.stderr
    assert "Traceback" not in ended.stderr and "secret" not in ended.stderr and not ended.stdout
    assert not os.path.exists("/tmp/polhode-nowhere/postgres")


@pytest.mark.parametrize(("arguments", "environment", "words"), WRONG, ids=ids(WRONG))
def test_what_is_wrong_is_told_in_a_sentence(monkeypatch, arguments, environment, words):
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    assert_one_sentence(polhode(*arguments), words)


@pytest.mark.slow
@pytest.mark.parametrize(("arguments", "environment", "words"), WRONG_FOR_LONG, ids=ids(WRONG_FOR_LONG))
def test_a_server_or_worker_that_cannot_start_says_why_in_a_sentence(arguments, environment, words):
    command = [sys.executable, "-m", "service.cli", *arguments]
    ended = subprocess.run(command, env=os.environ | environment, capture_output=True, text=True, check=False)
    assert_one_sentence(ended, words)


LATER = "revision 9999"
STORE = [
    ["queue"], ["regrade", "--faults"], ["assign", "rigid-body", "--grace", "5"], ["db", "upgrade"], ["db",
    "check"],
    ["token", "give", "ann"], ["token", "list"], ["unlink", "ann"], ["roster", "roster.csv", "--tokens",
    "tokens.csv"],
]  # fmt: skip


def test_every_command_refuses_tables_of_a_later_version_in_a_sentence(monkeypatch, database_url, tmp_path):
    monkeypatch.setenv("POLHODE_DATABASE_URL", database_url)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "roster.csv").write_text("name\nann\n")
    sql(database_url, "UPDATE alembic_version SET version_num = '9999'")
    for arguments in STORE:
        assert_one_sentence(polhode(*arguments), LATER)


@pytest.mark.slow
@pytest.mark.parametrize("arguments", [["serve", "--port", "0"], ["worker"]], ids=["serve", "worker"])
def test_a_server_or_worker_refuses_tables_of_a_later_version_in_a_sentence(database_url, arguments):
    sql(database_url, "UPDATE alembic_version SET version_num = '9999'")
    environment = os.environ | {"POLHODE_DATABASE_URL": database_url}
    command = [sys.executable, "-m", "service.cli", *arguments]
    ended = subprocess.run(command, env=environment, capture_output=True, text=True, check=False, timeout=60)
    assert_one_sentence(ended, LATER)
    assert ended.stderr.count("\n") == 1


def test_the_version_is_that_of_the_installed_distribution():
    assert polhode("--version") == (0, f"polhode {metadata.version('polhode')}\n", "")


def test_regrading_what_does_not_exist_and_rules_that_are_set(monkeypatch, database_url):
    monkeypatch.setenv("POLHODE_DATABASE_URL", database_url)
    told = polhode("regrade", "00000000-0000-0000-0000-000000000001")
    assert (
        told.returncode == 2 and told.stdout == "queued for regrading: 0\n" and "do not exist" in told.stderr
    )
    told = polhode("assign", "nope")
    assert told.returncode == 2 and "no assignment nope" in told.stderr


def test_a_server_without_the_kit_says_what_to_install():
    code = (
        "import sys\nsys.modules['polhode'] = None\nfrom service.cli.__main__ import main\nsys.exit(main())"
    )
    ended = subprocess.run(
        [sys.executable, "-c", code, "assignments"], capture_output=True, text=True, check=False
    )
    assert_one_sentence(ended, "polhode: the students' kit is not installed here: install polhode-kit again")
