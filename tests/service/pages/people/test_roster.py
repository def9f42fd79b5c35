"""The pages of the roster import: preview, questions, and the import."""

import re
from html import unescape

import pytest

from service.store.people import people
from tests.support.database import new_database, run, sql


@pytest.fixture(scope="module")
def url(postgres):
    url = new_database(postgres.url, "polhode")

    async def fill(database):
        roster = [
            ("prof", "instructor"),
            ("helper", "assistant"),
            ("zoe", "student", "Zoe <b>Adams</b>"),
            ("ben", "student", "Ben Ek", "ben@x.org", "0042"),
        ]
        async with database.begin() as connection:
            await people.enroll(connection, roster)

    run(url, fill)
    return url


@pytest.fixture
def upload(looks):
    """Send a roster, or the fields of a preview, to the preview or to the import."""

    def send(path, roster=None, /, **fields):
        files = {} if roster is None else {"files": {"roster": ("r.csv", roster)}}
        return looks("prof", path, at="/people", **files, **fields)

    return send


def leave(url, *names):
    sql(url, "DELETE FROM token USING person p WHERE p.id = person_id AND p.name = ANY(%s)", [*names])
    sql(url, "DELETE FROM member USING person p WHERE p.id = person_id AND p.name = ANY(%s)", [*names])
    sql(url, "DELETE FROM person WHERE name = ANY(%s)", [*names])


def hidden(page):
    """The fields of the form that imports what a preview shows."""
    form = page.partition('action="/people" ')[2].partition("</form>")[0]
    pairs = re.findall(r'type="hidden" name="([^"]*)" value="([^"]*)"', form)
    return {unescape(name): unescape(value) for name, value in pairs if name != "csrf"}


def keys(page):
    return re.findall(r'name="confirmed" value="(\w+)" required', page)


def test_a_roster_enters_people_and_may_give_tokens(looks, url):
    heads, fay = "Name,Role,Full name,Email,Student id", "fay,student,Fay Ønskov,fay@x.org,17"
    content = f"\ufeff{heads}\n{fay}\n=1+1,,,,\n\n".encode()
    given = {"files": {"roster": ("r.csv", content)}}
    status, page, _ = looks("prof", "/people/preview", at="/people", **given)
    assert status == 200 and "<b>2</b> new" in page and "Fay Ønskov" in page
    assert sql(url, "SELECT count(*) FROM person WHERE name = 'fay'") == [(0,)]
    assert looks("prof", "/people", at="/people", **given)[:2][0] == 200
    assert (
        "✓ Imported 2 people." in looks("prof", "/people?entered=2")[1]
        and "Fay Ønskov" in looks("prof", "/people")[1]
    )
    status, told, headers = looks("prof", "/people", at="/people", tokens="yes", **given)
    lines = told.splitlines()
    assert (
        status == 200
        and headers["content-disposition"] == 'attachment; filename="tokens.csv"'
        and len(lines) == 3
    )
    assert (
        lines[1].startswith("fay,polhode_")
        and sql(url, "SELECT count(*) FROM audit WHERE action = 'roster'")[0][0] == 2
    )
    leave(url, "fay", "=1+1")


BAD = {
    b"": "r.csv is empty",
    b"PK\x03\x04": "r.csv is a spreadsheet",
    b"\xff\xfea": "r.csv is not text",
}


@pytest.mark.parametrize("content", BAD)
def test_what_is_no_roster_is_refused(upload, content):
    status, page, _ = upload("/people/preview", content)
    assert status == 422 and BAD[content] in re.search(r'role="alert">(.*?)</span>', page, re.DOTALL)[1]


WRONG = {
    b"shoe\nann\n": "no column holds login names",
    b"name\n": "nobody would be imported",
    b"name\n" + b"x" * 300 + b"\n": "line 2: a name must have 1 to 200",
    b"name,email\nann,a\x07b\n": "line 2: the email address must have at most",
    b"name,role\nprof,assistant\n": "remove your own instructor role",
    b"name,email\nann,a\nann,b\n": "lines 2 and 3: ann has different values",
}


@pytest.mark.parametrize("content", WRONG)
def test_what_must_be_corrected_is_shown_and_imports_nobody(upload, url, content):
    before = sql(url, "SELECT count(*) FROM member")
    status, page, _ = upload("/people/preview", content)
    assert status == 200 and WRONG[content] in unescape(page.partition("Correct these first")[2])
    assert 'class="main"' not in page
    status, page, _ = upload("/people", content)
    assert status == 422 and "nothing was imported: " in page and WRONG[content] in unescape(page)
    assert sql(url, "SELECT count(*) FROM member") == before


def test_a_preview_shows_what_an_import_changes_and_imports_it(upload, url):
    """A roster of Gradescope in which one student has another address and one is new."""
    content = b"First Name;Last Name;SID;Email\nBen;Ek;0042;ben@new.org\nIvy;Ax;7;ivy@x.org\n"
    page = upload("/people/preview", content)[1]
    assert "<b>2</b> new, <b>0</b> changed" in page
    assert "ben@new.org (new) and ben share 0042" in page and len(keys(page)) == 1
    before_at = {**hidden(page), "column:login": "email address, the part before @"}
    page = upload("/people/preview", **before_at)[1]
    assert "<b>1</b> new, <b>1</b> changed and <b>0</b> unchanged" in page and not keys(page)
    assert "<s>ben@x.org</s> ben@new.org" in page
    assert "Zoe &lt;b&gt;Adams&lt;/b&gt;</a>" in page.partition("not in the file and stay")[2]
    assert sql(url, "SELECT email FROM person WHERE name = 'ben'") == [("ben@x.org",)]
    status, page, _ = upload("/people", **hidden(page))
    assert status == 200 and "✓ Imported 2 people." in page
    assert sql(url, "SELECT name, email FROM person WHERE name IN ('ben', 'ivy') ORDER BY 1") == [
        ("ben", "ben@new.org"), ("ivy", "ivy@x.org")]  # fmt: skip
    sql(url, "UPDATE person SET email = 'ben@x.org' WHERE name = 'ben'")
    leave(url, "ivy")


def test_every_question_must_be_confirmed(upload, url):
    content = "Kennung;Name;Rolle;Hut\nann;Änne Lee;Gast;1\nann;Änne Lee;Student;1\n".encode("cp1252")
    page = upload("/people/preview", content)[1]
    asked = keys(page)
    assert len(asked) == 3 and "Windows-1252 (guessed)" in page and "The role “Gast” means" in page
    status, page, _ = upload("/people", **hidden(page), confirmed=asked[0])
    assert status == 422 and "nothing was imported: confirm each point" in page
    assert f'value="{asked[0]}" required checked' in page
    assert sql(url, "SELECT 1 FROM person WHERE name = 'ann'") == []
    fields = {**hidden(page), "encoding": "Windows-1252", "role:Gast": "student", "column:section": "Hut"}
    page = upload("/people/preview", **fields)[1]
    (key,) = keys(page)
    assert "1 person is listed more than once" in page
    assert upload("/people", **hidden(page), confirmed=key)[0] == 200
    about = "SELECT full_name, section FROM person WHERE name = 'ann'"
    assert sql(url, about) == [("Änne Lee", "1")]
    leave(url, "ann")


@pytest.mark.parametrize("content", ["no base64!", "é"])
def test_a_file_that_was_changed_on_its_way_is_refused(upload, content):
    status, page, _ = upload("/people", content=content, file="r.csv")
    assert status == 422 and "the file was changed on its way: choose it again" in page


def test_ten_thousand_people_are_previewed_by_the_first_of_them(upload):
    lines = "".join(f"p{k:05},Person {k}\n" for k in range(10_001))
    status, page, _ = upload("/people/preview", f"name,full_name\n{lines}".encode())
    assert status == 422 and "more than 10000 people: split the file" in page
    shorter = lines.rpartition("p10000")[0]
    status, page, _ = upload("/people/preview", f"name,full_name\n{shorter}".encode())
    assert status == 200 and "<b>10000</b> new" in page and "The first 500 people" in page
    assert "p00499" in page and "p00500" not in page
