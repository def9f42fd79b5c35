"""The pages of people: the list, the roster import, a person, and the search."""

import re
from html import unescape

import pytest

from service.pages.people import listing
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


def test_a_long_list_has_pages(looks, monkeypatch):
    monkeypatch.setattr(listing, "MOST_PEOPLE", 4)
    pages = [looks("helper", f"/people?page={k}")[1] for k in (1, 2, 3)]
    shown = [len(re.findall(r'href="/person\?name=', page)) for page in pages]
    assert shown == [4, 2, 0] and "No people on page 3: the last one is 2" in pages[2]
    assert all("6 people: " in page and 'href="/people?page=2"' in page for page in pages)
    assert looks("helper", "/people?page=0")[0] == 422


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
