"""A new course with the pages alone: from ``polhode serve`` on an empty folder to the first graded submission
of a student.
"""

import re
import time
from datetime import UTC, datetime, timedelta

import pytest

from exercises.authoring.assignments.catalogue import find
from tests.support.axe import wrong

pytestmark = (
    pytest.mark.slow
)  # tests/service/pages/course/test_first_instructor.py and test_setup.py have the rules
PASSWORD = "correct horse battery"
OWN = "/assignments/rigid-body"
DUE = (datetime.now(UTC) + timedelta(days=7)).strftime("%Y-%m-%dT%H:%M")


@pytest.fixture(scope="module")
def server(new_server, tmp_path_factory):
    """``polhode serve`` on an empty folder, with all of its assignments and one worker."""
    data = tmp_path_factory.mktemp("new-course") / "data"
    return new_server(data, POLHODE_COURSE="rigid-body waves integrators", POLHODE_WORKERS="1")


def printed_link(server):
    deadline = time.monotonic() + 30
    while not (found := re.search(r"http://\S+/start#token=\S+", server.out.read_text())):
        assert time.monotonic() < deadline, server.out.read_text()
        time.sleep(0.05)
    return found[0]


def test_from_an_empty_folder_to_the_first_report(page, server):
    page.allowed += ["status of 422", "status of 403"]
    objections, prof = [], page()
    prof.goto(printed_link(server))
    prof.wait_for_function("() => !location.hash")
    assert server.url in prof.url and "token" not in prof.url
    objections += wrong(prof)
    fill(prof, {"Login name": "emmy", "Full name": "Emmy Noether", "Repeat password": PASSWORD})
    prof.get_by_label("Password (10").fill(PASSWORD)
    prof.get_by_role("button", name="Become the first instructor").click()
    prof.wait_for_url("**/setup")
    objections += wrong(prof)
    prof.set_viewport_size({"width": 1280, "height": 900})

    fill(prof, {"Name of the course": "Computational Physics II", "Term": "Winter"})
    prof.get_by_role("button", name="Save name, term and time zone").click()
    prof.get_by_text("Name, term and time zone saved.").wait_for()
    publish_with_deadline(prof)
    token = add_student(prof, objections)
    try_as_student(prof, server, objections)
    student = page()
    report = submit_as(student, server, token)
    objections += wrong(report)

    prof.goto(f"{server.url}/")
    assert "1 of 1 students submitted" in prof.locator("main").inner_text()
    assert objections == []


def fill(page, fields):
    for label, value in fields.items():
        page.get_by_label(label, exact=True).fill(value)


def publish_with_deadline(page):
    """Publish rigid-body; a deadline in the past asks first."""
    title = find("rigid-body").title
    page.get_by_label(f"Publish {title}").check()
    page.get_by_label(f"Deadline of {title}").fill("2020-01-01T12:00")
    assert page.get_by_label("The deadline is past on purpose").is_hidden()
    page.get_by_role("button", name="Save assignments").click()
    page.get_by_text("this deadline is past").wait_for()
    assert page.get_by_label("The deadline is past on purpose").is_visible()
    page.get_by_label(f"Deadline of {title}").fill(DUE)
    page.get_by_role("button", name="Save assignments").click()
    page.get_by_text("Assignments saved.").wait_for()
    page.get_by_text("✓ 1 published").wait_for()


def add_student(page, objections):
    """Add a student from the set-up page; return their token, which is shown once."""
    page.get_by_role("link", name="add a person").click()
    page.wait_for_url("**/people/add")
    objections += wrong(page)
    fill(page, {"Login name": "ben", "Full name": "Ben Ek", "Section": "A"})
    page.get_by_role("button", name="Add person").click()
    page.get_by_role("heading", name="New login of ben").wait_for()
    objections += wrong(page)
    return page.locator("#secret").inner_text()


def try_as_student(page, server, objections):
    """See the course as a student: one assignment, which is published, and a way back."""
    page.goto(f"{server.url}/setup")
    page.get_by_role("button", name="See the course as a student").click()
    page.get_by_text("You see the pages as a student does.").wait_for()
    assert page.locator(".tile h3").all_inner_texts() == [find("rigid-body").title]
    objections += wrong(page)
    page.get_by_role("button", name="Stop").click()
    page.get_by_role("link", name="People").wait_for()
    page.goto(f"{server.url}/person?name=ben")
    page.get_by_role("button", name="See the pages as Ben Ek does").click()
    page.get_by_text("You see the pages as ben does").wait_for()
    page.get_by_role("button", name="Stop").click()
    page.wait_for_url("**/person?name=ben")
    objections += wrong(page)


def submit_as(page, server, token):
    """Log in with the token, upload a right file, and return the page with its report."""
    page.goto(f"{server.url}{OWN}")
    assert page.url.startswith(f"{server.url}/login"), "people log in now"
    page.get_by_label("Token from your course").fill(token)
    page.get_by_role("button", name="Log in").click()
    page.wait_for_url(f"**{OWN}")
    page.get_by_label("Completed notebook or Python file").set_input_files(
        find("rigid-body").folder / "samples" / "right_all.py"
    )
    page.get_by_role("button", name="Submit").click()
    page.wait_for_url("**/submissions/*")
    page.get_by_text("36").first.wait_for(timeout=120_000)
    page.locator(".ring").first.wait_for()
    return page
