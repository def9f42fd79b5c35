"""Forms without JavaScript: a rejected form is shown again, with the reason beside its field and all that was
typed.
"""

import functools

import pytest

from tests.support.database import run
from tests.support.submissions import hand_in

pytestmark = pytest.mark.slow  # tests/service/pages/test_rejected_forms.py has the rules
CLASS = "/assignments/rigid-body/class"


@pytest.fixture
def visit(page, seen_by):
    """``visit(name, role, path)`` is that page, for that person."""
    page.allowed += ["status of 422", "status of 404"]
    return functools.partial(seen_by, javascript=False)


@pytest.fixture
def submission(url):
    verdicts = {"2-energy": "✗", "2-momentum": "✓", "2-motion": "✗"}
    return f"/submissions/{run(url, lambda database: hand_in(database, 'ann', verdicts))}"


def rejected(page, field, reason):
    """The page has this reason, it can be seen, and the field has the focus and refers to it."""
    error = page.locator("#refused")
    assert reason in error.inner_text() and "<title>Error: " in page.content()
    assert error.is_visible() and 0 < error.bounding_box()["y"] < page.viewport_size["height"]
    assert (
        field.get_attribute("aria-invalid") == "true" and field.get_attribute("aria-describedby") == "refused"
    )
    assert page.locator(":focus").get_attribute("name") == field.get_attribute("name")


def test_the_settings_of_the_course(visit):
    page = visit("prof", "instructor", "/settings")
    zone, penalty = (
        page.get_by_label("Time zone"),
        page.get_by_label("Percent of the points for each day late"),
    )
    for name in ("Mars/Phobos", 'Nowhere"><b>'):  # the second time from the page that answered the first
        zone.fill(name)
        penalty.fill("12.5")
        page.get_by_role("button", name="Save settings").click()
        rejected(page, zone, f"no time zone {name}")
        assert (zone.input_value(), penalty.input_value()) == (name, "12.5")
    zone.fill("Europe/Berlin")
    page.get_by_role("button", name="Save settings").click()
    page.wait_for_url("**/settings")
    assert not page.locator("#refused").count()
    assert (zone.input_value(), penalty.input_value()) == ("Europe/Berlin", "12.5")
    zone.fill("UTC")
    penalty.fill("0")
    page.get_by_role("button", name="Save settings").click()


def test_an_extension(visit, submission):
    page = visit("prof", "instructor", f"{CLASS}/settings")
    name, due, reason = (
        page.get_by_label("Name"),
        page.get_by_label("New deadline (UTC)"),
        page.get_by_label("Reason (required)"),
    )
    name.fill("nobody of that name")
    due.fill("2099-03-07T12:30")
    reason.fill("was <ill> for a week")
    page.get_by_role("button", name="Save extension").click()
    rejected(page, name, "nobody of that name")
    assert (due.input_value(), reason.input_value()) == ("2099-03-07T12:30", "was <ill> for a week")
    name.fill("ann")
    page.get_by_role("button", name="Save extension").click()
    page.get_by_role("button", name="Remove the extension of ann").wait_for()


def test_an_override(visit, submission):
    page = visit("prof", "instructor", submission)
    page.get_by_text("Override score").click()
    check, points, reason = (
        page.get_by_label("Check"),
        page.get_by_label("Points"),
        page.get_by_label("Reason (shown"),
    )
    check.select_option("2-energy")
    points.fill("1.5")
    reason.fill("the unit\nis right")
    page.get_by_role("button", name="Save override").click()
    rejected(page, points, "2-energy")
    assert (check.input_value(), points.input_value(), reason.input_value()) == (
        "2-energy",
        "1.5",
        "the unit\nis right",
    )
    points.fill("0.5")
    page.get_by_role("button", name="Save override").click()
    # Not until it has loaded: its chart of speed against accuracy waits for a worker, and there is none.
    page.wait_for_url(f"**{submission}#points", wait_until="domcontentloaded")
    assert "0.5" in page.get_by_role("table", name="Overridden scores").inner_text()


def test_a_regrade_request(visit, submission):
    page = visit("ann", "student", submission)
    page.get_by_text("Request a regrade").first.click()
    page.get_by_label("Reason").fill("  ")
    page.get_by_role("button", name="Request a regrade").click()
    rejected(page, page.get_by_label("Reason"), "enter the reason")
    page.get_by_label("Reason").fill("my units are J")
    page.get_by_role("button", name="Request a regrade").click()
    page.get_by_text("has not answered yet").wait_for()


def test_a_file_is_to_be_chosen_again(visit, tmp_path):
    page, file = visit("ben", "student", "/assignments/rigid-body"), tmp_path / "mine.py"
    file.write_bytes(b"\xff\xfe\x00")
    field = page.get_by_label("Completed notebook or Python file")
    for _ in range(2):
        field.set_input_files(file)
        page.get_by_role("button", name="Submit").click()
        assert "; choose the file again" in page.locator("#refused").inner_text()


def test_passwords_are_to_be_entered_again(visit):
    page = visit("ben", "student", "/account")
    password, again = page.get_by_label("New password ("), page.get_by_label("Repeat new password")
    password.fill("a polhode rolls for ben")
    again.fill("a herpolhode rolls for ben")
    page.get_by_role("button", name="Save password").click()
    rejected(page, again, "passwords do not match: type the new password again; enter the passwords again")
    assert password.input_value() == again.input_value() == ""


def test_a_login_that_fails_keeps_the_name(page, application):
    page.allowed.append("status of 401")
    new = page(java_script_enabled=False)
    new.goto(f"{application.url}/login")
    new.get_by_label("Name").fill("ann")
    new.get_by_label("Password", exact=True).fill("not hers")
    new.get_by_role("button", name="Log in").click()
    new.get_by_role("alert").wait_for()
    assert new.get_by_label("Name").input_value() == "ann"
