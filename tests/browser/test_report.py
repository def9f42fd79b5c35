"""The page of a wrong submission: what is wrong is seen at once, the page is short, and a phone shows it."""

import uuid

import pytest

from service.grading.submission import Submission
from service.store.submissions.accepting import accept
from service.store.submissions.records import NewSubmission
from tests.support.database import entered, run
from tests.support.submissions import grade_really

pytestmark = pytest.mark.slow
SIGN = """def euler_eqs(t, w, I):
    I1, I2, I3 = I
    return np.array([
        (I2 - I3) * w[1] * w[2] / I1,
        (I3 - I1) * w[2] * w[0] / I2,
        (I2 - I1) * w[0] * w[1] / I3,
    ])
"""
TALLEST = 2500
INSIDE = """element => {
    const box = element.getBoundingClientRect();
    return box.top >= 0 && box.bottom <= innerHeight;
}"""


@pytest.fixture(scope="module")
def path(url, sandbox):
    """The page of exercises 2 to 5 with a sign error in the third component."""

    async def sent(database):
        one = NewSubmission(
            uuid.uuid4(), "rigid-body", "ann", Submission(SIGN, "a.py", ["2", "3", "4", "5"]), 7
        )
        await accept(database, one)
        await grade_really(database, one.id, sandbox, {"grade": 1000.0})
        return f"/submissions/{one.id}"

    return run(url, sent)


@pytest.fixture
def shown(page, application, url, path):
    """``shown(width)`` is the page in a browser, with all of its pictures."""

    def opened(width):
        new = page(width=width, reduced_motion="reduce")
        new.goto(f"{application.url}/login?next={path}")
        new.get_by_label("Token from your course").fill(entered(url, "ann", None))
        new.get_by_role("button", name="Log in").click()
        new.locator("figure.motion canvas").first.wait_for()
        for image in new.locator("details[open] img").all():
            image.scroll_into_view_if_needed()
            image.evaluate("image => image.complete || new Promise(done => { image.onload = done })")
        new.evaluate("scrollTo(0, 0)")
        return new

    return opened


def test_the_first_window_shows_the_cause_the_line_and_the_motion(shown):
    page = shown(1280)
    first = page.locator(".first")
    assert first.locator(".sentence").inner_text() == "ω̇₃ has the opposite sign: check (I₁ − I₂)"
    assert first.locator("mark").inner_text() == "(I2 - I1) * w[0] * w[1] / I3"
    for part in (".sentence", ".quote", "canvas"):
        assert first.locator(part).evaluate(INSIDE), part
    assert "139.5° apart" in first.locator(".at").inner_text(), "where the motions differ most"
    assert float(first.locator(".sentence").evaluate("p => parseFloat(getComputedStyle(p).fontSize)")) >= 24


def test_the_page_is_short_and_what_has_the_same_cause_is_folded(shown):
    page = shown(1280)
    assert page.evaluate("document.documentElement.scrollHeight") <= TALLEST
    assert page.get_by_text("Exercises 3–5: the same cause, 13 checks").is_visible()
    assert page.locator("#check-3-energy").is_hidden() and page.locator("#check-2-energy").is_visible()
    figures = page.locator("#exercise-2 img.drawn")
    assert figures.count() == 2 and all(figure.is_visible() for figure in figures.all())
    page.get_by_role("link", name="Exercise 4").click()
    assert page.locator("#check-4-motion").is_visible(), "a chip opens what is folded"


def test_a_phone_shows_all_of_it_without_scrolling_sideways(shown):
    page = shown(390)
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    for part in (".sentence", ".quote"):
        assert page.locator(f".first {part}").evaluate(INSIDE), part
    names = page.locator("#exercise-2 .outcomes .name").all()
    assert {round(name.bounding_box()["x"]) for name in names} == {round(names[0].bounding_box()["x"])}
    below = page.locator("#check-2-motion .got").bounding_box()
    assert below["x"] == names[0].bounding_box()["x"] and below["x"] + below["width"] <= 390
