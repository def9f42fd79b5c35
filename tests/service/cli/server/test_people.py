"""polhode roster and token, run in this process on a database."""

import pytest

from tests.support.command_line import polhode
from tests.support.database import sql


@pytest.fixture
def database(database_url, monkeypatch):
    monkeypatch.setenv("POLHODE_DATABASE_URL", database_url)
    return database_url


def test_a_roster_is_imported_without_tokens_and_listed_in_the_format_of_an_import(database, tmp_path):
    header = "name,role,full_name,email,student_id\n"
    assert polhode("roster") == (0, header, "")
    people = tmp_path / "people.csv"
    people.write_text(header + 'prof,instructor,Prof. Hu,hu@example.org,\nann,student,"Lee, Ann",,17\n')
    assert polhode("roster", people) == (0, "imported 2 people, without tokens\n", "")
    assert polhode("roster") == (0, people.read_text(), "")
    assert polhode("token", "list") == (0, "no tokens\n", "")
    people.write_text(polhode("roster").stdout)
    assert polhode("roster", people, "--tokens", tmp_path / "tokens.csv").returncode == 0
    assert b"\r" not in (tmp_path / "tokens.csv").read_bytes(), (
        "a token that a shell reads from its line must not end in a CR"
    )
    assert sql(database, "SELECT detail FROM audit WHERE action = 'roster' ORDER BY id") == [
        ({"people": 2, "tokens": 0},),
        ({"people": 2, "tokens": 2},),
    ]


def test_a_token_is_given_to_a_person_of_the_course_only(database, tmp_path):
    code, token, why = polhode("token", "give", "Ann Lee")
    assert (code, token) == (2, "") and sql(
        database, "SELECT count(*) FROM person WHERE name <> 'local'"
    ) == [(0,)]
    assert why == (
        "polhode: no person named Ann Lee: import a roster with polhode roster, "
        "or add this person with polhode token give --new 'Ann Lee'\n"
    )
    code, token, why = polhode("token", "give", "--new", "Ann Lee")
    assert code == 0 and token.startswith("polhode_") and not why
    assert polhode("roster").stdout.splitlines()[1:] == ["Ann Lee,student,,,"]
    assert (
        polhode("token", "give", "Ann Lee").returncode
        == polhode("token", "give", "--new", "Ann Lee").returncode
        == 0
    )
    assert sql(database, "SELECT count(*) FROM person WHERE name <> 'local'") == [(1,)]
