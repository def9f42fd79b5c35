"""Commands of an operator: one sentence and an exit code where something is wrong."""

import os
import subprocess
import sys

import pytest


def polhode(*arguments, **environment):
    command = [sys.executable, "-m", "service.cli", *arguments]
    return subprocess.run(command, env=os.environ | environment, capture_output=True, text=True, check=False)


WRONG = [
    (["queue"], {"POLHODE_DATA": "/tmp/polhode-nowhere"}, "no database in /tmp/polhode-nowhere"),
    (["db", "backup", "x.dump"], {"POLHODE_DATA": "/tmp/polhode-nowhere"}, "no database in /tmp/polhode-nowhere"),
    (["worker"], {"POLHODE_DATA": "/tmp/polhode-nowhere"}, "POLHODE_DATABASE_URL is not set"),
    (["serve"], {"POLHODE_PORT": "abc"}, "POLHODE_PORT: "),
    (["serve"], {"POLHODE_DATABASE_URL": "mysql://root:secret@host/db"}, "POLHODE_DATABASE_URL: "),
    (["serve", "--host", "203.0.113.1"], {"POLHODE_DATA": "/tmp/polhode-nowhere"}, "203.0.113.1 port 8000"),
    (["queue"], {"POLHODE_DATABASE_URL": "postgresql://u:secret@127.0.0.1:1/db"}, "connection"),
    (["regrade"], {}, "which ones"),
    (["regrade", "--all", "--faults"], {}, "which ones"),
    (["assign", "rigid-body", "--grace", "nan"], {}, "between 0 and"),
    (["assign", "rigid-body", "--most", "0"], {}, "between 1 and"),
    (["assign", "rigid-body", "--due", "tomorrow"], {}, "no time such as"),
    (["assign", "rigid-body", "--due", "2026-12-01T12:00"], {}, "time zone"),
    (["export", "gradescope", "--out", "x.zip", "--assignment", "nope"], {}, "no assignment nope"),
    (["export", "gradescope", "--out", "x.zip", "--exercise", "9"], {}, "no exercise 9"),
    (["plan", "--students", "1000000000", "--minutes", "1", "--workers", "1"], {}, "at most"),
]


@pytest.mark.parametrize(("arguments", "environment", "words"), WRONG, ids=[" ".join(w[0]) for w in WRONG])
def test_what_is_wrong_is_told_in_a_sentence(arguments, environment, words):
    told = polhode(*arguments, **environment)
    assert told.returncode == 2 and words in told.stderr, told.stderr
    assert "Traceback" not in told.stderr and "secret" not in told.stderr and not told.stdout
    assert not os.path.exists("/tmp/polhode-nowhere/postgres")


def test_regrading_what_does_not_exist_and_rules_that_are_set(database_url):
    told = polhode("regrade", "00000000-0000-0000-0000-000000000001", POLHODE_DATABASE_URL=database_url)
    assert told.returncode == 2 and told.stdout == "queued again: 0\n" and "do not exist" in told.stderr
    told = polhode("assign", "nope", POLHODE_DATABASE_URL=database_url)
    assert told.returncode == 2 and "no assignment nope" in told.stderr
