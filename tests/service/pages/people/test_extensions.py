"""The page that gives extensions to many."""

from datetime import UTC, datetime, timedelta

import pytest

from service.store.people import people
from tests.support.database import new_database, run, sql

DUE = datetime(2099, 3, 1, 12, tzinfo=UTC)
FIELDS = {"who": "named", "names": "ann", "assignment-waves": "yes", "days": "2", "reason": "was ill"}


@pytest.fixture(scope="module")
def url(postgres):
    url = new_database(postgres.url, "polhode")

    async def fill(database):
        async with database.begin() as connection:
            await people.enroll(
                connection,
                [
                    ("prof", "instructor"),
                    ("helper", "assistant"),
                    ("ann", "student", "Ann Lee", "ann@x.org", "17", "A"),
                    ("ben", "student", "Ben Ek", "ben@x.org", "18", "B"),
                    ("lee", "student", "Ann Lee", "", "", "B"),
                    ("gone", "former", "Gus Ona", "", "", "A"),
                ],
            )

    run(url, fill)
    sql(url, "UPDATE assignment SET due_at = %s WHERE slug IN ('waves', 'rigid-body')", DUE)
    return url


@pytest.fixture
def give(looks, url):
    """Send the form as the instructor; return status, page and the extensions that there are then."""

    def send(**fields):
        status, page, _ = looks("prof", "/extensions", at="/extensions", **FIELDS | fields)
        of = "SELECT p.name, x.slug, e.due_at FROM extension e JOIN person p ON p.id = e.person_id JOIN"
        rows = sql(url, f"{of} assignment x ON x.id = e.assignment_id ORDER BY x.slug, p.name")
        return status, page, [(name, slug, (due - DUE).days) for name, slug, due in rows]

    yield send
    sql(url, "DELETE FROM extension")


@pytest.mark.parametrize("written", ["ann", "17", "ANN@x.org", "  ann "])
def test_one_student_by_name_address_or_id(give, written):
    status, page, extensions = give(names=written)
    assert status == 200 and "1 extension given" in page and extensions == [("ann", "waves", 2)]


def test_all_students_and_assignments(give):
    _, page, extensions = give(**{"who": "everybody", "assignment-rigid-body": "yes"})
    assert "6 extensions given" in page
    assert extensions == [
        (name, slug, 2) for slug in ("rigid-body", "waves") for name in ("ann", "ben", "lee")
    ]
    assert "0 extensions given" in give(who="everybody", days="1")[1]
    _, page, extensions = give(who="section:B", action="remove")
    assert "2 extensions removed" in page and len(extensions) == 4


def test_a_section_gets_one_date(give):
    _, page, extensions = give(who="section:B", days="", due="2099-03-05T12:00")
    assert extensions == [("ben", "waves", 4), ("lee", "waves", 4)]
    assert "was ill" in page and "2099-03-05 12:00" in page


PAST = (datetime.now(UTC) - timedelta(days=1)).strftime("%Y-%m-%dT%H:%M")
WRONG = {
    "nobody": ({"names": " \n "}, "enter the students"),
    "unknown": ({"names": "ann\nzoe <b>"}, "zoe &lt;b&gt; (nobody)"),
    "former": ({"names": "gone"}, "gone (nobody)"),
    "ambiguous": ({"names": "Ann Lee"}, "Ann Lee (ann or lee)"),
    "no time": ({"days": ""}, "enter either"),
    "two times": ({"due": "2099-03-05T12:00"}, "enter either"),
    "past": ({"days": "", "due": PAST}, "this deadline is past"),
    "no reason": ({"reason": ""}, "enter the reason"),
    "no number": ({"days": "x"}, "expected a number"),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_what_is_not_clear_extends_nothing_and_keeps_what_was_typed(give, wrong):
    fields, sentence = WRONG[wrong]
    status, page, extensions = give(**fields)
    assert status == 422 and sentence in page and extensions == []
    assert wrong == "no reason" or 'value="was ill"' in page


def test_no_assignment(looks, url):
    fields = {name: value for name, value in FIELDS.items() if not name.startswith("assignment")}
    status, page, _ = looks("prof", "/extensions", at="/extensions", **fields)
    assert status == 422 and "choose an assignment" in page


def test_drafts_and_assignments_without_a_deadline_are_not_offered(looks, url):
    page = looks("prof", "/extensions")[1]
    assert 'name="assignment-waves"' in page and 'name="assignment-integrators"' not in page
    sql(url, "UPDATE assignment SET published = false")
    assert "nothing can be extended" in looks("prof", "/extensions")[1]
    sql(url, "UPDATE assignment SET published = true")


def test_assistants_see_the_list_only(looks, give):
    give()
    page = looks("helper", "/extensions")[1]
    assert "1 extension in the course" in page and "<textarea" not in page
