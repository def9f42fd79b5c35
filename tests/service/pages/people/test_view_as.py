"""The staff sees the pages as a student does: as themselves, who may submit, or as one student, read only."""

import json
import urllib.error
import urllib.request

import pytest

from tests.support.database import entered, new_database, run, sql
from tests.support.http_client import HIDDEN, Browser
from tests.support.submissions import hand_in

OWN = "/assignments/rigid-body"
SOURCE = json.dumps({"source": "def euler_eqs(t, w, I):\n    return w\n"}).encode()


@pytest.fixture(scope="module")
def url(postgres):
    url = new_database(postgres.url, "polhode")
    for name, role in (("prof", "instructor"), ("helper", "assistant"), ("ben", "student")):
        entered(url, name, role)

    async def fill(database):
        return await hand_in(database, "ben", {"2-energy": "✓", "2-momentum": "✗"})

    sql(url, "INSERT INTO secret VALUES ('test', %s)", str(run(url, fill)))
    return url


@pytest.fixture(params=["prof", "helper"])
def staff(request, server, url):
    return Browser(server).log_in(token=entered(url, request.param, role=None))


def submission(url):
    ((id,),) = sql(url, "SELECT value FROM secret WHERE name = 'test'")
    return f"/submissions/{id}"


def submit(browser):
    """The status of a submission with the browser's cookies."""
    headers = {"Content-Type": "application/json", "Origin": browser.server.url}
    request = urllib.request.Request(f"{browser.server.url}/v1{OWN}/submissions", SOURCE, headers)
    try:
        with browser._opener.open(request, timeout=30) as answer:
            return answer.status
    except urllib.error.HTTPError as error:
        with error:
            return error.code


def view(browser, name=""):
    """Send the form of the front page, or that of the page of the person ``name``."""
    return browser.send(f"/person/view?name={name}" if name else "/view", page="/")


def test_the_staff_sees_the_course_as_a_student_and_submits(staff, url):
    status, page = view(staff)
    assert status == 200 and "You see the pages as a student does" in page
    assert "/people" not in page and "Start<" in page
    assert staff.open("/people")[0] == staff.open("/settings")[0] == 403
    assert staff.open(submission(url))[0] == 403, "another student's"
    assert "ben" not in staff.open(OWN)[1]
    status, page = (
        staff.send(f"{OWN}/submissions", page=OWN) if HIDDEN.search(staff.open(OWN)[1]) else (0, "")
    )
    assert staff.open("/account")[0] == 200
    status, page = staff.open("/view/stop", x="1")
    assert (status, staff.at) == (200, "/") and "/people" in page


def test_drafts_are_hidden_while_the_staff_sees_the_course_as_a_student(staff, url):
    sql(url, "UPDATE assignment SET published = false WHERE slug = 'waves'")
    assert staff.open("/assignments/waves")[0] == 200
    view(staff)
    assert "/assignments/waves" not in staff.open("/")[1] and staff.open("/assignments/waves")[0] == 404
    sql(url, "UPDATE assignment SET published = true WHERE slug = 'waves'")


def test_the_staff_sees_what_one_student_sees_and_changes_nothing(staff, url):
    status, page = view(staff, "ben")
    assert status == 200 and "You see the pages as <b>ben</b> does" in page and submission(url) in page
    for path in (OWN, submission(url)):
        assert staff.open(path)[0] == 200
    for path in ("/people", "/account", "/setup", f"{OWN}/class"):
        assert staff.open(path)[0] == 403, path
    token = HIDDEN.search(staff.open(submission(url))[1])
    for path, fields in (
        (f"{submission(url)}/regrade-requests", {"reason": "x"}),
        ("/account/logout-everywhere", {}),
        ("/login?code=BCDF-GHJK", {}),
    ):
        status, page = staff.open(path, csrf=token[1], **fields)
        assert status == 403 and "can change nothing" in page, path
    assert submit(staff) == 403
    of_ben = "SELECT count(*) FROM submission s JOIN person p ON p.id = s.person_id WHERE p.name = 'ben'"
    assert sql(url, of_ben) == [(1,)]
    staff.open("/view/stop", x="1")
    assert staff.at == "/person?name=ben"


def test_the_view_is_in_the_audit_log(staff, url):
    sql(url, "DELETE FROM audit")
    view(staff, "ben")
    assert sql(url, "SELECT action, subject FROM audit WHERE action = 'view as'") == [("view as", "ben")]


@pytest.mark.parametrize("name", ["prof", "helper"])
def test_only_a_student_can_be_viewed(staff, name):
    assert view(staff, name)[0] == 422 and view(staff, "nobody")[0] == 404
    assert "You see the pages" not in staff.open("/")[1]


def test_a_student_cannot_view_as_anybody_and_another_persons_cookie_is_nothing(server, url, staff):
    ben = Browser(server).log_in(token=entered(url, "ben", role=None))
    token = HIDDEN.search(ben.open("/account")[1])[1]
    assert ben.open("/view", csrf=token)[0] == ben.open("/person/view?name=ann", csrf=token)[0] == 403
    view(staff, "ben")
    other = Browser(server).log_in(token=entered(url, "tutor", "assistant"))
    other.cookies.set_cookie(staff.cookie("polhode_view"))
    page = other.open("/")[1]
    assert "You see the pages" not in page and "/people" in page
    ben.cookies.set_cookie(staff.cookie("polhode_view"))
    assert "You see the pages" not in ben.open("/")[1]


def test_who_becomes_staff_is_not_viewed_any_more_and_a_new_login_ends_the_view(server, url):
    prof = Browser(server).log_in(token=entered(url, "prof", role=None))
    entered(url, "cleo", "student")
    view(prof, "cleo")
    entered(url, "cleo", "assistant")
    assert "You see the pages" not in prof.open("/")[1]
    entered(url, "cleo", "student")
    assert "You see the pages" in prof.open("/")[1]
    prof.log_in(token=entered(url, "prof", role=None))
    assert "You see the pages" not in prof.open("/")[1]


def test_tokens_of_programs_and_other_sites_do_not_change_it(server, url, staff):
    view(staff, "ben")
    assert staff.open("/view/stop", origin="https://evil.example", x="1")[0] == 403
    assert "You see the pages" in staff.open("/")[1]
    cookie = f"polhode_view={staff.cookie('polhode_view').value}"
    program = Browser(server, Authorization=f"Bearer {entered(url, 'prof', role=None)}", Cookie=cookie)
    assert "<h1>People</h1>" in program.open("/people")[1]
