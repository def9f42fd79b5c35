"""Every page as axe sees it, in light and dark, wide and as a phone: nothing it objects to, nothing to push
sideways.
"""

import json
import urllib.request
from urllib.parse import urlsplit

import pytest
from fastapi.responses import HTMLResponse

from service.app import PAGES
from tests.support.app import App
from tests.support.axe import wrong
from tests.support.course_pages import fill
from tests.support.database import entered

pytestmark = pytest.mark.slow  # test_pages.py looks at three pages
SAME_AS_SUBMISSION = "/v1/submissions/{id}/report.html"


@pytest.fixture(scope="module")
def paths(url, sandbox):
    return fill(url, sandbox)


@pytest.fixture(scope="module")
def server(url, paths):
    started = App(database_url=url)
    yield started
    started.stop()


def log_in(page, server, token):
    page.goto(f"{server.url}/login")
    page.get_by_label("Token from your course").fill(token)
    page.get_by_role("button", name="Log in").click()
    page.locator("nav .me").wait_for()


def test_axe_sees_what_is_wrong(page, server):
    page = page()
    page.goto(f"{server.url}/login")
    page.evaluate(
        "document.querySelector('main').innerHTML = '<p class=\"wide-one\"><img src=\"data:,\">x</p><input>'"
    )
    page.evaluate("document.querySelector('.wide-one').style.width = '2000px'")
    told = " ".join(wrong(page))
    assert "image-alt" in told and "label" in told and "px wide at 360 px" in told


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("name", ["prof", "tutor", "ben", "ann"])
def test_every_page(page, server, url, paths, scheme, name):
    page.allowed += ["status of 404", "status of 403"]
    page = page(color_scheme=scheme, reduced_motion="reduce")
    page.goto(f"{server.url}/login?next=/people")
    found = [*wrong(page)]
    log_in(
        page, server, entered(url, name, {"prof": "instructor", "tutor": "assistant"}.get(name, "student"))
    )
    shown = {
        "prof": paths,
        "tutor": ("class", "students", "settings", "regrade", "failed", "requests"),
        "ben": ("course", "given", "attempts", "account", "people"),  # the last one is refused
        "ann": ("failed", "changed"),
    }[name]
    for what in shown:
        page.goto(server.url + paths[what])
        page.locator("button.keys").wait_for()
        found += wrong(page)
    assert found == []


def test_every_route_that_answers_with_a_page_is_among_them(paths):
    routes = [
        one
        for router in PAGES
        for one in router.routes
        if "GET" in one.methods and one.response_class is HTMLResponse
    ]
    looked_at = [urlsplit(path).path for path in paths.values()]
    assert len(routes) > 15
    assert [one.path for one in routes if not any(map(one.path_regex.match, looked_at))] == [
        SAME_AS_SUBMISSION
    ]


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_pages_that_answer_to_forms(page, server, url, paths, scheme, tmp_path):
    """Errors beside fields, questions, previews and confirmations."""
    page.allowed += ["status of 401", "status of 404", "status of 422"]
    page = page(color_scheme=scheme, reduced_motion="reduce")
    page.goto(f"{server.url}/login")
    page.get_by_label("Name").fill("ann")
    page.get_by_label("Password", exact=True).fill("not hers")
    page.get_by_role("button", name="Log in").click()
    page.get_by_role("alert").wait_for()
    found = [*wrong(page)]
    log_in(page, server, entered(url, "prof", "instructor"))
    page.goto(f"{server.url}/login?code={_login_code(server)}")
    page.get_by_role("button", name="Authorize").wait_for()
    found += wrong(page)
    page.get_by_role("button", name="Authorize").click()
    page.get_by_role("heading", level=1).wait_for()
    found += wrong(page)
    page.goto(server.url + paths["settings"])
    page.get_by_label("Name").fill("nobody of that name")
    page.get_by_label("New deadline (UTC)").fill("2020-03-07T12:30")
    page.get_by_role("button", name="Save extension").click()
    page.get_by_role("alert").first.wait_for()
    found += wrong(page)
    for what, label in (("course settings", "Time zone"), ("settings", "Name")):
        page.goto(server.url + paths[what])
        page.get_by_label(label).fill("nothing of that name")
        page.get_by_label(label).evaluate("field => field.form.submit()")  # as without JavaScript
        page.locator("#refused").wait_for()
        found += wrong(page)
    roster = tmp_path / "class.csv"
    roster.write_text("name,role,full_name\nzoe,student,Zoë Ågård\nann,former,\n")
    page.goto(server.url + paths["people"])
    page.get_by_label("Roster file").set_input_files(roster)
    page.get_by_role("button", name="Preview import").click()
    page.get_by_role("button", name="Import 2 people").wait_for()
    found += wrong(page)
    page.goto(f"{server.url}/submissions/none")
    found += wrong(page)
    assert found == []


def _login_code(server):
    """Ask for a login as a notebook does."""
    request = urllib.request.Request(
        f"{server.url}/v1/logins", b'{"label": "a notebook"}', {"Content-Type": "application/json"}
    )
    with urllib.request.urlopen(request, timeout=30) as answer:
        return json.load(answer)["user_code"]
