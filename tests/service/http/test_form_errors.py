"""A rejected form is shown again: the rules on pages made here, and which requests are answered so by a
server.
"""

import re
from html.parser import HTMLParser

import pytest

from service.http.form_errors import refill
from tests.support.database import entered
from tests.support.http_client import Browser, call

PAGE = """<!doctype html><html><head><title>T</title><noscript><meta http-equiv="refresh" content="2"></noscript></head><body>
<datalist id="z"><option value="a"><option value="b"></datalist>
<form method="post" action="/notes"><input type="hidden" name="id" value="7"><button>Remove</button></form>
<details><summary>More</summary>
<form method="post" action="/notes?old=1"><input type="hidden" name="csrf" value="new"><input type="hidden" name="id" value="8">
<p><label>Points <input type="number" name="points" value="1" required></label></p>
<label>Note <textarea name="note" rows="2">old</textarea></label>
<select name="kind"><option value="x" selected>X</option>
<optgroup label="g"><option value="y">Y</option><option>Z</option></optgroup></select>
<input type="checkbox" name="late" checked> <input type="radio" name="who" value="one">
<input type="radio" name="who" value="all" checked>
<button name="do" value="save">Save</button></form></details>
<form method="post" action="/files"><input type="file" name="file"><input type="password" name="secret"></form>
<form method="get" action="/search"><input name="q"></form>
</body></html>"""
TYPED = {
    "csrf": ["stale"],
    "id": ["8"],
    "points": ['9"><b>'],
    "note": ["\n</textarea><b>"],
    "kind": ["y"],
    "who": ["one"],
    "do": ["save"],
}


class Tags(HTMLParser):
    """The start tags of a page by name, with their attributes, and the text of its areas."""

    def __init__(self, page):
        super().__init__()
        self.found, self.text, self._area = [], {}, None
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.found.append((tag, dict(attrs)))
        self._area = (
            dict(attrs).get("name" if tag == "textarea" else "id") if tag in ("textarea", "span") else None
        )

    def handle_endtag(self, tag):
        self._area = None

    def handle_data(self, data):
        if self._area:
            self.text[self._area] = self.text.get(self._area, "") + data

    def of(self, name, value=None):
        """The attributes of a control."""
        return next(
            a for _, a in self.found if a.get("name") == name and (value is None or a.get("value") == value)
        )


def shown(path="/notes", typed=None, detail="wrong & <bad>", name="points"):
    return refill(
        PAGE,
        path,
        address="/person?name=ann&b=1",
        typed=TYPED if typed is None else typed,
        detail=detail,
        name=name,
    )


def test_every_kind_of_field_has_what_was_typed():
    page = shown()
    tags = Tags(page)
    assert tags.of("points")["value"] == '9"><b>' and "<b>" not in page
    assert tags.text["note"] == "\n\n</textarea><b>"  # a browser leaves out the first line break
    options = [(a.get("value"), "selected" in a) for tag, a in tags.found if tag == "option"]
    assert options == [("a", False), ("b", False), ("x", False), ("y", True), (None, False)]
    assert '<option selected="">Z' in shown(typed=TYPED | {"kind": ["Z"]})
    assert "checked" not in tags.of("late")
    assert "checked" in tags.of("who", "one") and "checked" not in tags.of("who", "all")
    assert tags.of("csrf")["value"] == "new"


def test_the_error_is_beside_its_field_and_can_be_seen():
    page = shown()
    tags = Tags(page)
    assert {"aria-invalid": "true", "aria-describedby": "refused", "autofocus": ""}.items() <= tags.of(
        "points"
    ).items()
    assert tags.text["refused"] == "wrong & <bad>"
    assert re.search(r'name="points"[^>]* aria-invalid[^>]*></label><span class="refused"', page)
    assert '<details open="">' in page and "<title>Error: T</title>" in page and "refresh" not in page


@pytest.mark.parametrize("name", ["", "unknown", "id", "do"])
def test_an_error_of_no_field_is_at_the_beginning_of_the_form(name):
    page = shown(name=name)
    assert re.search(
        r'<form [^>]*><span class="refused" id="refused" role="alert" tabindex="-1" autofocus>wrong', page
    )
    assert "aria-invalid" not in page


def test_the_form_is_that_which_was_sent():
    removed = shown(typed={"id": ["7"]}, name="")
    assert removed.index("refused") < removed.index("Remove") and Tags(removed).of("points")["value"] == "1"
    assert shown(typed={"id": ["8"], "points": ["2"]}).index("refused") > shown().index("Remove")
    assert shown(path="/other") is None and shown(typed={"unknown": ["1"]}) is None


def test_what_no_page_can_contain_is_asked_for():
    page = shown("/files", typed={"secret": ["hunter2"]}, name="file")
    assert (
        Tags(page).text["refused"] == "wrong & <bad>; choose the file again; enter the passwords again"
        and "hunter2" not in page
    )


def test_the_forms_then_say_where_their_page_is():
    actions = [a["action"] for tag, a in Tags(shown()).found if tag == "form"]
    query = "?page=/person%3Fname%3Dann%26b%3D1"
    assert actions == [f"/notes{query}", f"/notes{query}", f"/files{query}", "/search"]


@pytest.fixture(scope="module")
def server(new_app, url):
    return new_app(database_url=url)


@pytest.fixture
def prof(server, url):
    return Browser(server).log_in(token=entered(url, "prof", "instructor"))


def settings(prof, server, referer="{}/settings", **headers):
    """Status and page of a wrong time zone that is sent from the page ``referer``."""
    prof.headers |= {"Referer": referer.format(server.url), **headers}
    try:
        return prof.send("/settings", page="/settings", time_zone="Mars/Phobos", late_penalty="5")
    finally:
        prof.headers.pop("Referer")


def test_a_rejected_form_is_on_its_page_also_the_second_time(prof, server):
    for referer in ("{}/settings", "{}/settings?page=/settings"):
        status, page = settings(prof, server, referer)
        assert status == 422 and "<h1>Course settings</h1>" in page and 'value="Mars/Phobos"' in page
        assert Tags(page).text["refused"].startswith("no time zone Mars/Phobos")
        assert 'action="/settings?page=/settings' in page


@pytest.mark.parametrize(
    "referer",
    [
        "",
        "http://example.org/settings",
        "{}/queue/events",
        "{}/openapi.json",
        "{}/people",
        "{}/none",
        "{}/submissions/none",
        "//x",
        "http://[",
    ],
)
def test_otherwise_the_error_is_a_page(prof, server, referer):
    """The form came from no page, from another server, from an address that is not HTML (one never ends) or
    lacks this form.
    """
    status, page = settings(prof, server, referer)
    assert status == 422 and "<h1>Invalid request</h1>" in page and "no time zone Mars/Phobos" in page


def test_a_page_that_is_compressed_for_browsers_can_be_read(prof, server):
    status, page = settings(
        prof, server, "{}/assignments/rigid-body/class/students", **{"Accept-Encoding": "gzip"}
    )
    del prof.headers["Accept-Encoding"]
    assert status == 422 and "no time zone Mars/Phobos" in page


def test_an_expired_form_is_shown_again_with_a_new_token(prof, server):
    prof.headers["Referer"] = f"{server.url}/settings"
    status, page = prof.open("/settings", csrf="0" * 64, time_zone="Europe/Berlin")
    assert status == 403 and "this form has expired" in Tags(page).text["refused"]
    assert (
        Tags(page).of("time_zone")["value"] == "Europe/Berlin" and Tags(page).of("csrf")["value"] != "0" * 64
    )


def test_programs_get_a_problem(prof, server, url):
    headers = {
        "Referer": f"{server.url}/settings",
        "Authorization": f"Bearer {entered(url, 'prof', 'instructor')}",
    }
    status, received, _ = call(server, "/settings", b"time_zone=x", **headers)
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
