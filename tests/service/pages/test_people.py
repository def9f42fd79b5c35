"""The pages of people: the list, the roster import, a person, and the search."""

import re
from html import unescape

import pytest

from service.store.course import deadlines, overrides
from service.store.people import people
from tests.support.database import new_database, run, sql
from tests.support.submissions import hand_in

NAME = "ann/../?b&c"


@pytest.fixture(scope="module")
def url(postgres):
    url = new_database(postgres.url, "polhode")

    async def fill(database):
        roster = [
            ("prof", "instructor"),
            ("helper", "assistant"),
            ("zoe", "student", "Zoe <b>Adams</b>"),
            ("gone", "former"),
        ]
        async with database.begin() as connection:
            await people.enroll(connection, [*roster, ("ben", "student", "Ben Ek", "ben@x.org", "0042")])
        first = await hand_in(database, "ben", {"2-energy": "✓", "2-momentum": "✗"}, filename="energy.py")
        await hand_in(database, "ben", {"2-energy": "✗", "2-momentum": "✗"}, filename="later.py")
        await hand_in(database, NAME, None)
        await overrides.give(
            database, first, "prof", check="2-momentum", points=1, reason="a typing error", seen=0
        )
        return first

    sent = run(url, fill)
    sql(
        url,
        "UPDATE assignment SET due_at = '2099-01-01T12:00Z', submission_limit = 5 WHERE slug = 'rigid-body'",
    )
    later = sql(url, "SELECT timestamptz '2099-02-01T12:00Z'")[0][0]
    why = {"reason": "was ill", "by": "prof"}
    assert run(url, lambda database: deadlines.extend(database, "rigid-body", "ben", later, **why))
    sql(url, "INSERT INTO secret VALUES ('test', %s)", str(sent))
    return url


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
    sql(url, "DELETE FROM token WHERE label = 'issued with the roster'")
    sql(url, "DELETE FROM member USING person p WHERE p.id = person_id AND p.name IN ('fay', '=1+1')")


BAD = {
    b"": "must name the columns",
    b"shoe\nann\n": "must name the columns",
    b"name,shoe\nann,1\n": "not &#39;shoe&#39;",
    b"name\n": "has no entries",
    b"name\n\xff\n": "not CSV text in UTF-8",
    b"name,role\nann,boss\n": "line 2: a role must be one of",
    b"name,role\nann,student\nann,assistant\n": "line 3: ann is listed twice with different values",
    b"name\n" + b"x" * 300 + b"\n": "line 2: a name must have 1 to 200",
    b"name,email\nann,a\x07b\n": "line 2: email must have at most",
    b"name,role\nprof,student\n": "remove your own instructor role",
}


@pytest.mark.parametrize("content", BAD)
def test_what_is_no_roster_enters_nobody(looks, url, content):
    before = sql(url, "SELECT count(*) FROM member")[0][0]
    status, page, _ = looks("prof", "/people/preview", at="/people", files={"roster": ("r.csv", content)})
    told = re.search(r'role="alert">(.*?)</span>', page, re.DOTALL)[1]
    assert status == 422 and BAD[content] in told
    assert sql(url, "SELECT count(*) FROM member")[0][0] == before


def test_a_preview_shows_what_an_import_changes_and_imports_it(looks, url):
    """A roster of Gradescope in which one student has another address and one is new."""
    content = "First Name;Last Name;SID;Email\nBen;Ek;0042;ben@new.org\nIvy;Ax;7;ivy@x.org\n"
    preview = {"files": {"roster": ("g.csv", content.encode())}}
    page = looks("prof", "/people/preview", at="/people", **preview)[1]
    assert "<option selected>Email</option>" in page and "<b>2</b> new, <b>0</b> changed" in page
    shown = unescape(re.search(r'name="content" value="([^"]*)"', page)[1])
    page = looks(
        "prof", "/people/preview", at="/people", file="g.csv", content=shown, login="email, the part before @"
    )[1]
    assert (
        "<b>1</b> new, <b>1</b> changed and <b>0</b> unchanged" in page
        and "<s>ben@x.org</s> ben@new.org" in page
    )
    assert "Zoe &lt;b&gt;Adams&lt;/b&gt;</a>" in page.partition("not in the file and stay")[2]
    assert sql(url, "SELECT email FROM person WHERE name = 'ben'") == [("ben@x.org",)]
    status, page, _ = looks(
        "prof", "/people", at="/people", file="g.csv", content=shown, login="email, the part before @"
    )
    assert status == 200 and "✓ Imported 2 people." in page
    assert sql(url, "SELECT name, email FROM person WHERE name IN ('ben', 'ivy') ORDER BY 1") == [
        ("ben", "ben@new.org"), ("ivy", "ivy@x.org")]  # fmt: skip
    sql(url, "UPDATE person SET email = 'ben@x.org' WHERE name = 'ben'")
    sql(url, "DELETE FROM member USING person p WHERE p.id = person_id AND p.name = 'ivy'")


def test_a_page_of_a_person(looks, url):
    """Assignments with points and the own deadline, all submissions, overrides, and the students beside."""
    status, page, _ = looks("helper", "/person?name=ben")
    assert status == 200 and "<h1>Ben Ek</h1>" in page and "0042" in page and "ben@x.org" in page
    (row,) = re.findall(
        r"<tr><th scope=\"row\"><a href=\"/assignments/rigid-body/class\">.*?</tr>", page, re.DOTALL
    )
    ((best,),) = sql(url, "SELECT value FROM secret WHERE name = 'test'")
    assert (
        f'<a href="/submissions/{best}">2</a> of 36 + 6 bonus, overridden' in row and "<td>2 of 5</td>" in row
    )
    assert 'datetime="2099-02-01T12:00:00+00:00"' in row and "was ill" in row
    assert (
        page.index("later.py") < page.index("energy.py")
        and "2: |L| conserved" in page
        and "a typing error" in page
    )
    assert (
        looks("helper", "/person?name=prof")[0] == 200
        and 'rel="prev"' not in looks("helper", "/person?name=prof")[1]
    )


def test_next_and_previous_lead_through_the_class(looks):
    seen = []
    page = looks("helper", "/person?name=zoe")[1]
    while found := re.search(r'rel="prev" href="([^"]*)"', page):
        page = looks("helper", unescape(found[1]))[1]
    while True:
        seen.append(unescape(re.search("<dt>Login name</dt><dd>(.*?)</dd>", page)[1]))
        if not (found := re.search(r'rel="next" href="([^"]*)"', page)):
            break
        page = looks("helper", unescape(found[1]))[1]
    assert seen == ["zoe", NAME, "ben"]  # "<b>Adams</b>", a login name, and Ek


def test_reports_lead_the_staff_from_student_to_student(looks):
    report = re.search(r'href="(/submissions/[0-9a-f-]+)"', looks("helper", "/person?name=ben")[1])[1]
    page = looks("helper", report)[1]
    before = re.search(r'rel="prev" href="([^"]*)"', page)[1]
    assert 'rel="next"' not in page  # zoe submitted nothing
    assert re.search(r'rel="next" href="/submissions/[0-9a-f-]+"', looks("helper", before)[1])
    assert 'rel="prev"' not in looks("ben", report)[1]


def test_every_name_has_a_page_that_the_list_links(looks):
    page = looks("helper", "/people")[1]
    links = [unescape(link) for link in re.findall(r'href="(/person\?name=[^"]*)"', page)]
    assert len(links) == 6 and "local" not in page
    for link in links:
        assert looks("helper", link)[0] == 200, link
    assert looks("helper", "/person?name=nobody")[0] == looks("helper", "/person?name=%00")[0] == 404
    assert looks("ben", "/person?name=ben")[0] == looks("ben", "/search?q=ben")[0] == 403


def test_the_search_finds_people_submissions_and_assignments(looks, url):
    ((best,),) = sql(url, "SELECT value FROM secret WHERE name = 'test'")
    for text in ("BEN@", "0042", "ben e", "ben"):
        page = looks("helper", f"/search?q={text.replace(' ', '+')}")[1]
        assert "/person?name=ben" in page and "name=zoe" not in page, text
    sql(url, "UPDATE person SET full_name = 'Zoë Ågård-Øst' WHERE name = 'gone'")
    for text in ("zoe+ag", "%C3%85G%C3%85RD", "zo%C3%A9+ag", "%C3%B8st"):
        assert "name=gone" in looks("helper", f"/search?q={text}")[1], text
    assert f"/submissions/{best}" in looks("helper", f"/search?q={best[:9]}")[1]
    page = looks("helper", "/search?q=ENERGY.py")[1]
    assert f"/submissions/{best}" in page and "later.py" not in page
    assert "/assignments/rigid-body/class" in looks("helper", "/search?q=rigid")[1]
    for text in ("nothing of this", "%25", "_", "%00q!"):
        assert "Nothing matches" in looks("helper", f"/search?q={text.replace(' ', '+')}")[1], text
    assert looks("helper", "/search")[0] == 200
