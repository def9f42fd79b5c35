"""Texts that would like to be more than text, in every field that takes one: on every page they are shown and
do nothing.
"""

import json
import urllib.parse
import urllib.request

import pytest

from tests.support.app import App
from tests.support.course_pages import BASE, fill
from tests.support.database import entered
from tests.support.hostile import CORPUS, SHOWN, SOURCE, TAGS, TEXTS, inert

pytestmark = pytest.mark.slow  # test_pages.py has the same texts on the pages that show most of them


@pytest.fixture(scope="module")
def paths(url, sandbox):
    return fill(url, sandbox, SOURCE, **TEXTS)


@pytest.fixture(scope="module")
def server(url, paths):
    started = App(database_url=url)
    yield started
    started.stop()


@pytest.fixture
def looking(page, server, url):
    """Log somebody in, with a browser that calls itself by the corpus, and open pages; what was asked by
    scripts is kept.
    """

    def opened(name, role):
        new = page(user_agent=f"Mozilla {TAGS}")
        new.on("dialog", lambda dialog: page.told.append(dialog.message) or dialog.dismiss())
        new.goto(f"{server.url}/login?next=/account")
        new.get_by_label("Token from your course").fill(entered(url, name, role))
        new.get_by_role("button", name="Log in").click()
        new.locator("nav .me").wait_for()
        return new

    page.told = []
    page.allowed += ["status of 404", "status of 422", "status of 401", "status of 409"]
    yield opened
    assert page.told == []


def test_nothing_runs_on_any_page(looking, server, paths):
    page = looking("prof", "instructor")
    for what, path in paths.items():
        page.goto(server.url + path)
        page.locator("button.keys").wait_for()
        page.locator("details:not([open]) > summary").evaluate_all("all => all.forEach(one => one.click())")
        assert SHOWN.get(what, "") in inert(page), what


def test_nothing_runs_on_the_student_s_own_pages(looking, server, paths):
    page = looking(TEXTS["name"], "student")
    assert TAGS in page.locator("nav .me").inner_text() and "a browser" in inert(page)
    for what in ("course", "passed", "failed", "changed", "attempts"):
        page.goto(server.url + paths[what])
        page.locator("button.keys").wait_for()
        inert(page)
    page.goto(server.url + paths["failed"])
    assert "<script>window.pwned" in page.locator(".first").inner_text()
    assert "�" in page.locator("#source").text_content()


def test_what_an_address_says_is_shown_and_does_nothing(looking, server):
    page, told = looking("prof", "instructor"), urllib.parse.quote(CORPUS[:380])
    body = json.dumps({"label": TAGS}).encode()
    asked = urllib.request.Request(f"{server.url}/v1/logins", body, {"Content-Type": "application/json"})
    with urllib.request.urlopen(asked, timeout=30) as answer:
        code = json.load(answer)["user_code"]
    several = (
        f"/audit?subject={told[:150]}", f"{BASE}/class/submissions?cause={told}",
        f"{BASE}/class/submissions?check={told[:90]}&state=x",
        f"/login?code={code}", f"/login?next={told}", f"/login?code={told[:20]}",
        f"/submissions/{urllib.parse.quote(TAGS, safe='')}",
        f"/regrades/{urllib.parse.quote(TAGS, safe='')}", f"/account?done={told}",
    )  # fmt: skip
    for path in several:
        page.goto(server.url + path)
        page.locator("button.keys").wait_for()
        inert(page)
    page.goto(f"{server.url}/login?code={code}")
    assert page.locator("q").inner_text().startswith(TAGS[:50])


def test_what_a_form_was_sent_comes_back_as_text(looking, server, paths, tmp_path):
    page, file = looking("prof", "instructor"), tmp_path / "bad.csv"
    page.goto(server.url + paths["settings"])
    page.get_by_label("Name").fill(CORPUS[:180])
    page.get_by_label("New deadline (UTC)").fill("2036-01-01T00:00")
    page.get_by_label("Reason").fill(CORPUS[:380])
    page.get_by_role("button", name="Save extension").click()
    page.get_by_text("no person named").wait_for()
    inert(page)
    for content in (f"name,role\nzoe,{TAGS}\n", f"name,{TAGS}\n", f'"{CORPUS}'):
        file.write_text(content)
        page.goto(server.url + paths["people"])
        page.locator("summary", has_text="Import roster").click() if not page.get_by_label(
            "Roster file"
        ).is_visible() else None
        page.get_by_label("Roster file").set_input_files(file)
        page.get_by_role("button", name="Preview import").click()
        page.get_by_text("bad.csv").first.wait_for()
        inert(page)


def test_a_login_that_fails_gives_the_name_back_as_text(page, server):
    page.allowed += ["status of 401"]
    page = page()
    page.goto(f"{server.url}/login")
    page.get_by_label("Name").fill(TAGS)
    page.get_by_label("Password", exact=True).fill("x")
    page.get_by_role("button", name="Log in").click()
    page.get_by_text("name or password is wrong").wait_for()
    inert(page)
    assert page.get_by_label("Name").input_value() == TAGS


def test_a_name_that_reads_from_right_to_left_turns_nothing_around_it(looking, server, page):
    page = looking("prof", "instructor")
    page.goto(f"{server.url}/account")
    order = """rule => {
        const p = document.createElement("p"), b = document.createElement("b");
        b.textContent = "שרה"; p.append("By ", b, " 7 of 9"); document.querySelector("main").append(p);
        if (rule) b.style.unicodeBidi = rule;
        const range = document.createRange();
        range.setStart(p.lastChild, 1); range.setEnd(p.lastChild, 2);
        return range.getBoundingClientRect().left > b.getBoundingClientRect().right - 1;
    }"""
    assert page.evaluate(order, "") and not page.evaluate(order, "normal"), (
        "ours, and what it would be without"
    )
