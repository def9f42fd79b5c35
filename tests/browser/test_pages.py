"""A short way through the pages for each role, in one browser, in a course whose every text is hostile; the
other files go on.
"""

import re
import uuid

import pytest

from service.grading.submission import Submission
from service.store.submissions.accepting import accept
from service.store.submissions.records import NewSubmission
from tests.support.app import App
from tests.support.axe import wrong
from tests.support.course_pages import BASE, fill
from tests.support.database import entered, run
from tests.support.hostile import SHOWN, SOURCE, TAGS, TEXTS, inert
from tests.support.submissions import grade_really

REVERSED = "def euler_eqs(t, w, I):\n    return -np.cross(I * w, w) / I\n"
PIXELS = "canvas => canvas.toDataURL()"
STAFF_ONLY = ("/people", f"{BASE}/class", "/queue", f"{BASE}/regrades", "/audit")


@pytest.fixture(scope="module")
def paths(url, sandbox):
    """Addresses of pages by what they show, ``moving`` among them: a motion of cleo, the equations of which
    are reversed.
    """

    async def moving(database):
        one = NewSubmission(uuid.uuid4(), "rigid-body", "cleo", Submission(REVERSED, "cleo.py", ["2"]), 7)
        await accept(database, one)
        await grade_really(database, one.id, sandbox, {"grade": 1000.0})
        return f"/submissions/{one.id}"

    return fill(url, sandbox, SOURCE, **TEXTS) | {"moving": run(url, moving)}


@pytest.fixture(scope="module")
def server(url, paths):
    started = App(database_url=url)
    yield started
    started.stop()


@pytest.fixture
def seen_by(page, server, url):
    """``seen_by("prof", "/people")`` is a page in a browser of their own, in which they have logged in by
    their token.
    """

    def opened(name, path="/"):
        new = page(reduced_motion="reduce", user_agent=f"Mozilla {TAGS}")
        new.goto(server.url + path)
        assert new.title() == "Log in · polhode"
        new.get_by_label("Token from your course").fill(entered(url, name, role=None))
        new.get_by_role("button", name="Log in").click()
        new.locator("nav .me").wait_for()
        assert new.url == server.url + path
        return new

    opened.allowed = page.allowed
    return opened


def heading(page):
    return page.get_by_role("heading", level=1).inner_text()


def show(page, address):
    """Open it and wait for its script."""
    answer = page.goto(address)
    page.locator("button.keys").wait_for()
    return answer


def test_a_student_sets_a_password_sees_a_motion_and_no_page_of_the_staff(seen_by, server, paths):
    seen_by.allowed.append("status of 403")
    page, password = seen_by("cleo"), "a polhode rolls for cleo"
    for path in (*STAFF_ONLY, paths["failed"]):
        assert show(page, server.url + path).status == 403 and heading(page) == "Permission denied", path
    page.locator("nav .me").click()
    page.get_by_label("New password (").fill(password)
    page.get_by_label("Repeat new password").fill(password)
    page.get_by_role("button", name="Save password").click()
    page.get_by_text("✓ Password saved. Other browsers are logged out.").wait_for()
    page.get_by_role("button", name="Log out", exact=True).click()
    page.get_by_text("You are logged out.").wait_for()
    page.get_by_label("Name").fill("cleo")
    page.get_by_label("Password", exact=True).fill(password)
    page.get_by_role("button", name="Log in").click()
    page.locator("table[data-rows] tbody a").first.click()
    assert page.url.endswith(paths["moving"])
    figure = page.locator("figure.motion").first
    figure.get_by_role("button", name="▶ Play").wait_for()
    figure.scroll_into_view_if_needed()
    canvas, slider = figure.locator("canvas"), figure.get_by_role("slider", name="Time")
    before = canvas.evaluate(PIXELS)
    slider.fill("10000")
    assert canvas.evaluate(PIXELS) != before and re.match(
        r"10.00 s, [1-9]", figure.locator(".at").inner_text()
    )


@pytest.mark.slow
def test_an_assistant_filters_the_class_cancels_what_runs_and_may_not_decide(seen_by, server, paths):
    seen_by.allowed.append("status of 403")
    page = seen_by("tutor", f"{BASE}/class/students")
    page.locator("button.keys").wait_for()
    page.keyboard.press("/")
    page.keyboard.type("CLEO")
    assert page.locator("#heat > tbody > tr:visible").count() == 1
    page.evaluate("document.activeElement.blur()")
    page.keyboard.press("j")
    page.keyboard.press("o")
    page.wait_for_url(f"**{paths['moving']}*")
    assert page.locator("form[action$='/overrides']").count() == 0
    show(page, f"{server.url}/queue")
    page.evaluate("window.been = true")
    running = page.get_by_role("button", name="Cancel the grading of")
    before = running.count()
    running.first.click()
    page.get_by_text("cancelled by tutor").nth(1).wait_for()
    assert page.get_by_role("button", name="Cancel the grading of").count() == before - 1
    for path in ("/people", f"{BASE}/rules"):
        show(page, f"{server.url}{BASE}/regrades")
        with page.expect_navigation() as going:  # the page's own form, sent elsewhere
            page.evaluate(
                "path => { const form = document.querySelector('main form'); form.action = path;"
                " form.submit(); }",
                path,
            )
        assert going.value.status == 403 and heading(page) == "Permission denied", path


@pytest.mark.slow
def test_an_instructor_enters_a_roster_and_gives_points_that_the_student_sees(
    seen_by, server, paths, tmp_path
):
    page, file = seen_by("prof", "/people"), tmp_path / "class.csv"
    file.write_text("name,role,full_name\nzoe,student,Zoë Ågård\n")
    page.locator("summary", has_text="Import roster").click()
    page.get_by_label("Roster file").set_input_files(file)
    page.get_by_role("button", name="Preview import").click()
    page.get_by_role("button", name="Import 1 person").click()
    page.get_by_text("Imported 1 person.").wait_for()
    page.get_by_label("Filter").fill("agard")
    assert page.locator("#people > tbody > tr:visible").count() == 1
    show(page, server.url + paths["moving"])
    page.get_by_text("Override score").click()
    page.get_by_label("Check").select_option("2-motion")
    page.get_by_label("Points").fill("1")
    page.get_by_label("Reason (shown to the student)").fill(TAGS)
    page.get_by_role("button", name="Save override").click()
    page.get_by_text("(graded ").wait_for()
    cleo = seen_by("cleo", paths["moving"])
    assert TAGS in cleo.locator("#points").inner_text() and "(graded " in inert(cleo)


@pytest.mark.slow
def test_nothing_runs_on_the_pages_that_show_most(seen_by, server, paths):
    page = seen_by("prof")
    for what in ("students", "people", "queue", "audit", "failed", "changed", "applied"):
        show(page, server.url + paths[what])
        page.locator("details:not([open]) > summary").evaluate_all("all => all.forEach(one => one.click())")
        assert SHOWN[what] in inert(page), what


@pytest.mark.slow  # test_accessible.py does so with every page
def test_axe_objects_to_nothing_and_pages_fit_a_phone(seen_by, page, server, paths):
    plain = page()
    show(plain, f"{server.url}/login")
    found = [*wrong(plain, (360,))]
    shown = seen_by("prof")
    for what in ("students", "moving"):
        show(shown, server.url + paths[what])
        found += wrong(shown)
    assert found == []
    plain.evaluate(
        "document.querySelector('main').innerHTML = '<p class=\"wide-one\"><img src=\"data:,\">x</p><input>'"
    )
    plain.evaluate("document.querySelector('.wide-one').style.width = '2000px'")
    told = " ".join(wrong(plain, (360,)))
    assert "image-alt" in told and "label" in told and "px wide at 360 px" in told
