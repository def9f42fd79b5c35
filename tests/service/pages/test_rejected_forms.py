"""A rejected form is shown again by its page, with the reason beside the field and with what was typed."""

import re
from html import unescape
from html.parser import HTMLParser

import pytest

from service.auth.forms import MOST_FORM
from tests.support.database import entered, run
from tests.support.http_client import Browser, call
from tests.support.submissions import hand_in, submitted

OWN = "/assignments/rigid-body"
SETTINGS = f"{OWN}/class/settings"
HOSTILE = '9"><b>\n</textarea><script>'
FORM = re.compile(r'<form\b[^>]*method="post" action="([^"]+)"[^>]*>(.*?)</form>', re.DOTALL)
HIDDEN = re.compile(r'<input type="hidden" name="([^"]+)" value="([^"]*)">')


class Tags(HTMLParser):
    """The start tags of a page with their attributes, and the text of its areas and of its errors."""

    def __init__(self, page):
        super().__init__()
        self.found, self.text, self._area = [], {}, None
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.found.append((tag, dict(attrs)))
        self._area = dict(attrs).get("name" if tag == "textarea" else "id")

    def handle_endtag(self, tag):
        self._area = None

    def handle_data(self, data):
        if self._area:
            self.text[self._area] = self.text.get(self._area, "") + data

    def of(self, name):
        """The attributes of the only control of that name that has no hidden value."""
        (found,) = [a for _, a in self.found if a.get("name") == name and a.get("type") != "hidden"]
        return found

    def chosen(self, mark):
        """The values of what is selected or checked."""
        return [a.get("value") for _, a in self.found if mark in a]


@pytest.fixture(scope="module")
def prof(server, url):
    return Browser(server).log_in(token=entered(url, "prof", "instructor"))


@pytest.fixture(scope="module")
def ann(server, url):
    return Browser(server).log_in(token=entered(url, "ann"))


@pytest.fixture(scope="module")
def submission(url):
    return f"/submissions/{run(url, lambda database: hand_in(database, 'ann', {'2-energy': '✗'}))}"


@pytest.fixture(scope="module")
def pages(prof, ann, submission, url):
    """The pages that have forms, with something to send in each of these."""
    waiting, _ = submitted(url, "ann")
    failed, grading = submitted(url, "ann")
    ann.send(f"{submission}/regrade-requests", submission, reason="look")
    prof.send(f"{submission}/overrides", submission, check="", points="1", reason="kind")
    prof.send(f"{submission}/comments", submission, cell="1", line="1", comment="so")
    prof.send("/person/notes?name=ann", "/person?name=ann", note="ill")
    prof.send(f"{OWN}/release", SETTINGS, scores="manually", details="manually")
    due = {"published-rigid-body": "yes", "due-rigid-body": "2098-01-01T00:00"}
    prof.send("/setup/assignments", "/setup", **due)
    prof.send(f"{OWN}/extensions", SETTINGS, name="ann", due="2099-01-01T00:00", reason="ill")
    prof.send(f"/queue/{grading}/cancel", "/queue")
    assert prof.send(f"{OWN}/regrades", f"{OWN}/regrades", which="all")[0] == 200
    return [
        "/", "/account", "/people", "/people/add", "/person?name=ann", "/settings", "/setup", "/extensions",
        "/queue", SETTINGS, f"{OWN}/class",
        f"{OWN}/class/submissions?check=2-energy&state=fail", f"{OWN}/regrades", f"{OWN}/regrade-requests",
        submission, f"/submissions/{waiting}", f"/submissions/{failed}", prof.at,
    ]  # fmt: skip


def test_every_form_is_shown_again_on_its_page(prof, pages):
    """With a new token and with the reason, where the form that was sent is."""
    tried = set()
    for path in pages:
        status, page = prof.open(path)
        assert status == 200, path
        for action, content in FORM.findall(page):
            fields = dict(HIDDEN.findall(content))
            if "csrf" not in fields:
                continue
            action, buttons = (
                unescape(action),
                re.findall(r'<button name="(action)" value="([^"]*)"', content),
            )
            status, again = prof.open(action, **fields | dict(buttons) | {"csrf": "0" * 64})
            assert status == 403 and "<title>Error: " in again, action
            (said,) = [one for one in FORM.findall(again) if 'id="refused"' in one[1]]
            assert unescape(said[0]) == action and "this form has expired" in said[1]
            assert dict(HIDDEN.findall(said[1]))["csrf"] == fields["csrf"] and again.count('"refused"') == 2
            for same in (r"<h1>.*?</h1>", r'href="[^"]*" aria-current="page"'):
                assert re.findall(same, again) == re.findall(same, page), action
            tried.add(re.sub(r"[0-9a-f-]{36}", "ID", action.partition("?")[0]))
    assert tried >= {
        "/account/password", "/account/revoke", "/account/logout-everywhere", "/people/preview",
        "/people/add", "/person/edit", "/person/token", "/person/password", "/person/view",
        "/person/notes", "/settings", "/setup/course", "/setup/assignments", "/extensions", "/view",
        "/setup/view",
        "/queue/ID/cancel", "/queue/ID/retry", f"{OWN}/rules",
        f"{OWN}/extensions", f"{OWN}/release", f"{OWN}/class/submissions", f"{OWN}/regrades",
        f"{OWN}/regrade-requests/ID/answer", f"{OWN}/submissions/ID/regrades", "/submissions/ID/overrides",
        "/submissions/ID/overrides/ID/withdraw", "/submissions/ID/comments",
        "/submissions/ID/comments/ID/delete", "/submissions/ID/regrade-requests/ID/answer",
        "/regrades/ID/drop",
    }  # fmt: skip


def test_the_reason_is_beside_its_field_and_what_was_typed_stays(prof):
    for zone in ("Mars/Phobos", HOSTILE, "Mars/Phobos"):
        fields = {"time_zone": zone, "late_penalty": "12.5", "weight-rigid-body": ""}
        status, page = prof.send("/settings", "/settings", **fields)
        tags = Tags(page)
        assert status == 422 and "<title>Error: Course settings" in page and "<b>" not in page
        assert tags.text["refused"].startswith(f"no time zone {zone.strip()[:20]}")
        assert (
            tags.of("time_zone").items()
            >= {
                "value": zone,
                "aria-invalid": "true",
                "aria-describedby": "refused",
                "autofocus": None,
            }.items()
        )
        assert re.search(
            r'name="time_zone"[^>]*></label><span class="refused" id="refused" role="alert">', page
        )
        assert (tags.of("late_penalty")["value"], tags.of("weight-rigid-body")["value"]) == ("12.5", "")
        assert page.count("aria-invalid") == page.count('id="refused"') == 1


def test_areas_lists_and_choices_have_what_was_typed(prof, submission):
    typed = "\n" + HOSTILE
    fields = {"check": "2-energy", "points": "many", "reason": typed}
    status, page = prof.send(f"{submission}/overrides", submission, **fields)
    tags = Tags(page)
    assert status == 422 and tags.of("points")["value"] == "many" and "<script>" not in page
    assert tags.text["reason"].removeprefix("\n") == typed  # a browser leaves out the first line break
    assert tags.chosen("selected")[0] == "2-energy"
    assert re.search(r"<details open>\s*<summary>Override score", page)
    assert "<details open>\n<summary>Override score" not in prof.open(submission)[1]
    status, page = prof.send(f"{OWN}/regrades", f"{OWN}/regrades", which="check", check="2-none")
    assert status == 422 and Tags(page).chosen("checked") == ["check"]
    status, page = prof.send(f"{OWN}/release", SETTINGS, scores="never", details="deadline")
    assert status == 422 and Tags(page).chosen("selected") == ["yes", "deadline"]


def test_a_reason_about_no_field_is_at_the_beginning_of_the_form(prof):
    status, page = prof.open("/settings", csrf="0" * 64, time_zone="Europe/Berlin")
    ((_, content),) = [form for form in FORM.findall(page) if form[0] == "/settings"]
    error = '<span class="refused" id="refused" role="alert" tabindex="-1" autofocus>this form has expired'
    assert status == 403 and HIDDEN.sub("", content).startswith(error) and "aria-invalid" not in page
    assert Tags(page).of("time_zone")["value"] == "Europe/Berlin"


def test_one_form_of_several_has_the_reason(prof, pages):
    """A note that somebody else removed has no form any more, and the form of a new one is another."""
    path, page = "/person/notes?name=ann", "/person?name=ann"
    status, shown = prof.send(path, page, remove="7e31d4f0-0000-4000-8000-000000000000")
    assert status == 404 and "<title>Page not found" in shown
    assert "no note with this id: reload the page" in shown
    status, shown = prof.send(path, page, note="  ")
    assert status == 422 and shown.partition('id="refused"')[0].count("Remove</button>") == 1


def test_what_no_page_can_contain_is_asked_for(prof, ann):
    fields = {"password": "a polhode rolls", "again": "a herpolhode rolls"}
    status, page = prof.send("/account/password", "/account", **fields)
    assert status == 422 and "rolls" not in page
    assert Tags(page).text["refused"].endswith("type the new password again; enter the passwords again")
    status, page = prof.send("/people/preview", "/people")
    assert status == 422 and Tags(page).text["refused"].endswith("choose a file first; choose the file again")
    status, page = ann.open(f"{OWN}/submissions", file="text, no upload")
    assert status == 415 and Tags(page).text["refused"].endswith("; choose the file again")
    for fields in ({"name": "ann", "password": "not hers"}, {"token": "polhode_not_hers"}):
        status, page = Browser(prof.server).send("/login", **fields)
        assert status == 401 and "not hers" not in page and "polhode_not_hers" not in page


def test_too_long_a_form_is_shown_again_empty(prof):
    status, page = prof.send("/settings", "/settings", time_zone="x" * MOST_FORM)
    assert status == 413 and "the form is larger than" in Tags(page).text["refused"]
    assert Tags(page).of("time_zone")["value"] == "UTC"


def test_a_page_that_reloads_itself_waits_for_the_form(prof, pages):
    waiting = pages[-3]
    assert 'http-equiv="refresh"' in prof.open(waiting)[1]
    status, page = prof.send(f"{waiting}/comments", waiting, cell="1", line="99", comment="mind this")
    assert status == 422 and Tags(page).text["comment"].strip() == "mind this" and "refresh" not in page


def test_a_login_is_asked_for_again_with_its_code_and_aim(server):
    login = "/login?code=&next=%2Fpeople%3Fx%3D1%26y%3D2"
    status, page = Browser(server).send(login, login, name="ann", password="not hers")
    assert status == 401 and Tags(page).of("name")["value"] == "ann"
    assert unescape(FORM.search(page)[1]) == login


def test_without_the_form_the_error_is_a_page(prof, ann, submission):
    """Its page has no such form (any more), or the person may not see that page."""
    nothing = "00000000-0000-4000-8000-000000000000"
    for path in (f"/queue/{nothing}/retry", f"{submission}/comments/{nothing}/delete"):
        status, page = prof.send(path, "/account")
        assert status in (404, 409) and re.search(r"<title>(Page not found|Changed in the meantime) ", page)
        assert 'class="fault" role="alert"' in page and "reload the" in page
    status, page = ann.send("/settings", "/account", time_zone="UTC")
    assert status == 403 and "<h1>Permission denied</h1>" in page


def test_programs_get_a_problem(server, url):
    token = f"Bearer {entered(url, 'prof', 'instructor')}"
    status, received, _ = call(server, "/settings", b"time_zone=x", Authorization=token)
    assert status == 403 and received["content-type"] == "application/problem+json"


def test_only_pages_without_a_token_are_compressed(server, url):
    headers = {"Authorization": f"Bearer {entered(url, 'prof', 'instructor')}", "Accept-Encoding": "gzip"}
    for path, compressed in (
        ("students", True),
        ("submissions", True),
        ("submissions?check=2-energy", False),
    ):
        status, received, _ = call(server, f"/assignments/rigid-body/class/{path}", **headers)
        assert (status, received["content-encoding"] == "gzip") == (200, compressed), path
