"""polhode roster and token, run in this process on a database."""

import pytest

from tests.support.command_line import polhode
from tests.support.database import sql


@pytest.fixture
def database(database_url, monkeypatch):
    monkeypatch.setenv("POLHODE_DATABASE_URL", database_url)
    return database_url


def test_a_roster_is_imported_without_tokens_and_listed_in_the_format_of_an_import(database, tmp_path):
    header = "name,role,full_name,email,student_id,section\n"
    assert polhode("roster") == (0, header, "")
    people = tmp_path / "people.csv"
    people.write_text(header + 'prof,instructor,Prof. Hu,hu@example.org,,\nann,student,"Lee, Ann",,17,B\n')
    columns = (
        "login name: name, full name: full_name, email address: email, student ID: student_id, role: role,"
        " section: section\n"
    )
    assert polhode("roster", people) == (0, columns + "imported 2 people, without tokens\n", "")
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
    assert polhode("roster").stdout.splitlines()[1:] == ["Ann Lee,student,,,,"]
    assert (
        polhode("token", "give", "Ann Lee").returncode
        == polhode("token", "give", "--new", "Ann Lee").returncode
        == 0
    )
    assert sql(database, "SELECT count(*) FROM person WHERE name <> 'local'") == [(1,)]


UNCLEAR = "Vorname;Nachname;Kennung;Rolle;Schuhgröße\nAnn;Lee;ann;Gast;1\nBo;\x1bEk;;Student;2\n"


def test_what_is_not_understood_ends_with_2_and_imports_nobody(database, tmp_path):
    """Until it is confirmed, or explained by an option."""
    file = tmp_path / "people.csv"
    file.write_text(UNCLEAR + "Cem;Li;cem;Student;3\n", encoding="cp1252")
    code, _, why = polhode("roster", file, "--tokens", tmp_path / "tokens.csv")
    assert code == 2 and not (tmp_path / "tokens.csv").exists()
    assert sql(database, "SELECT count(*) FROM person") == [(1,)]
    assert why == (
        "polhode: nothing was imported from people.csv; correct it, or confirm with --confirm:\n"
        "  The file is not in UTF-8 and was read as Windows-1252: these words must look right.\n"
        "    Schuhgröße\n"
        "  These columns are not understood and not imported.\n"
        "    Schuhgröße\n"
        "  1 line has no login name and will be skipped.\n"
        "    line 3: Bo, ?Ek, Student, 2\n"
        "  The role “Gast” is not understood: 1 person is skipped.\n"
        "    line 2\n"
    )
    told = polhode("roster", file, "--role", "Gast=former", "--confirm")
    assert told.returncode == 0 and told.stdout.endswith("imported 2 people, without tokens\n")
    assert polhode("roster").stdout.splitlines()[1:] == ["cem,student,Cem Li,,,", "ann,former,Ann Lee,,,"]


def test_columns_and_encoding_are_options(database, tmp_path):
    file = tmp_path / "people.csv"
    file.write_text("shoe;Nachname\nann;Łoś\n", encoding="cp1250")
    options = ["--column", "login=shoe", "--encoding", "Windows-1250"]
    code, _, why = polhode("roster", file)
    assert code == 2 and "it has shoe, Nachname: choose the column with the login names\n" in why
    assert polhode("roster", file, *options).returncode == 0
    assert polhode("roster").stdout.splitlines()[1:] == ["ann,student,Łoś,,,"]
    wrong = polhode("roster", file, "--column", "login=hat", "--encoding", "Windows-1250")
    assert (wrong.returncode, wrong.stderr) == (
        2,
        "polhode: no column is called hat: the file has shoe, Nachname\n",
    )
    assert "expected NAME=VALUE" in polhode("roster", file, "--column", "login").stderr
