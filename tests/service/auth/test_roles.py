"""Three roles and every page there is: what a page is open to is read from the routes, and tried by each of
them.
"""

import json
import re
import urllib.error
import urllib.request

import pytest
from fastapi.routing import APIRoute

from service import app
from service.auth import roles
from service.auth.identity import same_origin
from tests.support.database import entered, new, run
from tests.support.http_client import HIDDEN, Browser

UPLOAD = "/assignments/{slug}/submissions"
ROLES = ("student", "assistant", "instructor")
RANK = {role: rank for rank, role in enumerate(ROLES)}
# Pages that nobody has to be known for. Whatever else has no role declared fails below.
OPEN = {
    "/help",
    "/docs",
    "/login",
    "/logout",
    "/start",
    "/view/stop",
    "/oidc/login",
    "/oidc/callback",
    "/reference",
    "/reference/{kind}-{number}.svg",
}
LEAST = {roles.current_user: "student", roles.staff: "assistant", roles.instructor: "instructor"}


def routes():
    """(method, path, the least role) of every page; None for what is open to all."""
    for router in app.PAGES:
        for route in router.routes:
            assert isinstance(route, APIRoute)
            asked = [LEAST[call] for call in calls(route.dependant) if call in LEAST]
            least = max(asked, key=RANK.get) if asked else None
            yield from ((method, route.path, least) for method in sorted(route.methods))


def calls(dependant):
    for dependency in dependant.dependencies:
        yield dependency.call
        yield from calls(dependency)


PAGES = sorted(routes(), key=str)
GUARDED = [(method, path, least) for method, path, least in PAGES if least is not None]


@pytest.fixture(scope="module")
def browsers(server, url):
    """Somebody of each role who has logged in."""
    return {role: Browser(server).log_in(token=entered(url, f"a {role}", role)) for role in ROLES}


@pytest.fixture(scope="module")
def submission(url):
    """The id of what a student called ann sent."""
    from service.store.submissions.accepting import accept

    sent = new("ann")
    run(url, lambda database: accept(database, sent, None))
    return str(sent.id)


def filled(path, submission):
    """The path with something for each of its parameters."""
    known = {"slug": "rigid-body", "id": submission, "form": "canvas"}
    return re.sub(r"\{(\w+)(?::\w+)?\}", lambda part: known.get(part[1], "1"), path)


def tried(browser, method, path):
    """Status and, of a problem, its sentence; a form has the token that the role's own pages put into
    theirs.
    """
    body = b"csrf=" + HIDDEN.search(browser.open("/account")[1])[1].encode() if method == "POST" else None
    request = urllib.request.Request(
        browser.server.url + path, body, {"Accept": "application/json"}, method=method
    )
    try:
        with browser._opener.open(request, timeout=30) as answer:
            return answer.status, ""
    except urllib.error.HTTPError as error:
        with error:
            return error.code, json.loads(error.read())["detail"]


def test_every_page_declares_whom_it_is_for():
    undeclared = {path for _, path, least in PAGES if least is None} - OPEN
    assert not undeclared, "declare Looking, Staff or Instructor; or add it to those that are open"
    assert not {path for _, path, least in GUARDED} & OPEN and len(GUARDED) >= 8


def test_what_students_may_open_and_what_only_instructors_may_do():
    """The rest is for all of the staff. Here it stands once more, so that no page changes its role by
    mistake.
    """
    students = {path for _, path, least in GUARDED if least == "student"}
    own = {
        "/submissions/{id}",
        "/submissions/{id}/comments/{comment}/answer",
        "/submissions/{id}/diff",
        "/submissions/{id}/source",
        "/assignments/{slug}/notebook",
        "/submissions/{id}/motions/{name}.json",
        "/v1/submissions/{id}/report.html",
    }
    account = {"/account", "/account/logout-everywhere", "/account/password", "/account/revoke"}
    assert students == {
        "/",
        "/assignments/{slug}",
        UPLOAD,
        "/submissions/{id}/regrade-requests",
        *own,
        *account,
    }
    points = {
        "/submissions/{id}/overrides",
        "/submissions/{id}/overrides/{override}/withdraw",
        "/regrades/{id}/apply",
    }
    terms = {
        "/assignments/{slug}/rules",
        "/assignments/{slug}/extensions",
        "/assignments/{slug}/release",
        "/settings",
        "/setup/course",
        "/setup/assignments",
    }
    changes = {path for method, path, least in GUARDED if least == "instructor" and method == "POST"}
    person = {"/people/add", "/person/edit", "/person/token", "/person/password", "/person/extensions"}
    assert changes == {*points, *terms, *person, "/extensions", "/people", "/people/preview"}


def test_another_site_cannot_submit(browsers):
    status, page = browsers["student"].open(
        UPLOAD.format(slug="rigid-body"), origin="https://evil.example", file="x = 1"
    )
    assert status == 403 and "another site" in page


def test_every_form_is_checked():
    from service.auth import forms

    for router in app.PAGES:
        for route in router.routes:
            # the submission's parser reads its form; the others are in compressed pages
            if route.path in (
                UPLOAD,
                "/logout",
                "/view/stop",
            ):
                assert same_origin in set(calls(route.dependant))
            elif "POST" in route.methods:
                assert {forms.checked_form, forms.checked_public_form} & set(calls(route.dependant)), (
                    route.path
                )


@pytest.mark.parametrize(("method", "path", "least"), GUARDED)
@pytest.mark.parametrize("role", ROLES)
def test_a_role_gets_its_pages_and_no_others(browsers, submission, role, method, path, least):
    if RANK[role] < RANK[least]:
        status, why = tried(browsers[role], method, filled(path, submission))
        assert status == 403 and why in (
            "you don't have permission: only course staff can do this",
            "you don't have permission: only instructors can do this",
        )
    elif method == "GET":
        status, why = tried(browsers[role], method, filled(path, submission))
        own = role == "student" and "{id}" in path
        assert (
            (status, why) == (403, "you don't have permission: another student sent this submission")
            if own
            else status in (200, 303, 404)
        ), why
        assert status != 404 or "{" in path, why


@pytest.mark.parametrize(("method", "path", "least"), GUARDED)
def test_who_is_not_logged_in_gets_none(server, submission, method, path, least):
    browser = Browser(server)
    if method == "GET":
        assert browser.open(filled(path, submission))[0] == 200 and browser.at.startswith("/login")
    else:
        assert browser.open(filled(path, submission), x="1")[0] == 200 and browser.at == "/login"


def test_students_see_what_they_sent_and_get_403_for_what_others_sent(server, url, browsers, submission):
    own = Browser(server).log_in(token=entered(url, "ann"))
    reports = ("/report.txt", "/report.junit.xml", "/report.html")
    parts = ("", "/events", *reports, "/figures/omega.png", "/animations/a.png", "/sweep.json")
    for path in (f"/submissions/{submission}", *(f"/v1/submissions/{submission}{part}" for part in parts)):
        assert tried(browsers["student"], "GET", path) == (
            403,
            "you don't have permission: another student sent this submission",
        ), path
        for browser in (own, browsers["assistant"], browsers["instructor"]):
            assert tried(browser, "GET", path)[0] in (200, 404, 409), path
    assert tried(browsers["student"], "GET", "/v1/submissions/00000000-0000-0000-0000-000000000000")[0] == 404
