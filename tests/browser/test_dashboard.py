"""The dashboard with real clicks and typing: three roles log in, an instructor goes through a class, the
queue and a regrade.
"""

import csv
import io
import json
import re
import urllib.request
import zipfile

import pytest

from polhode.judging.outcome import Diagnosis
from tests.support.database import entered, run, sql
from tests.support.reports import SLIP
from tests.support.submissions import hand_in

pytestmark = pytest.mark.slow  # test_pages.py has the way of each role in short
BASE = "/assignments/rigid-body"
GOOD = "def euler_eqs(t, w, I):\n    return -np.cross(w, I * w) / I\n"
NOTHING = "def euler_eqs(t, w, I):\n    pass\n"
LOOP = (  # in a motion, which may take longer than the points
    GOOD.replace(":\n", ":\n    calls.append(t)\n    while len(calls) > 2000:\n        pass\n")
    + "calls = []\n"
)
OTHER = Diagnosis("cyclic-order", "ω̇₂ multiplies ω₁·ω₂ where ω₃·ω₁ belongs", 1.0)
ROLES = {
    "prof": "instructor",
    "tutor": "assistant",
    "ann": "student",
    "ben": "student",
    "cleo": "student",
    "dan": "student",
}
STUDENTS, SETTINGS = f"{BASE}/class/students", f"{BASE}/class/settings"
STAFF_ONLY = (
    "/people",
    f"{BASE}/class",
    STUDENTS,
    f"{BASE}/class/checks",
    SETTINGS,
    f"{BASE}/class/submissions",
    "/queue",
    f"{BASE}/regrades",
    "/audit",
    "/grades.csv",
)


@pytest.fixture(scope="module")
def tokens(url):
    return {name: entered(url, name, role) for name, role in ROLES.items()}


@pytest.fixture(scope="module")
def sent(url, tokens):
    """Ids of what the class handed in, by student."""

    async def fill(database):
        return {
            "ann": await hand_in(
                database, "ann", {"2-energy": ("✗", 1e-3, SLIP), "2-momentum": "✓"}, source=GOOD
            ),
            "ben": await hand_in(database, "ben", {"2-energy": "✓", "2-momentum": "✓"}, source=GOOD),
            "cleo": await hand_in(
                database, "cleo", {"2-energy": ("✗", 0.1, OTHER), "2-momentum": "⏱"}, source=GOOD
            ),
            "dan": await hand_in(
                database, "dan", {"2-energy": ("✗", 0.1, SLIP), "2-momentum": "✓"}, source=NOTHING
            ),
        }

    return {name: str(id) for name, id in run(url, fill).items()}


@pytest.fixture(scope="module")
def server(new_server, tmp_path_factory, url, sent):
    """It has one worker."""
    own = {"POLHODE_DATABASE_URL": url, "POLHODE_WORKERS": "1", "POLHODE_IDENTITY": "token"}
    started = new_server(tmp_path_factory.mktemp("dashboard") / "data", "/livez", **own)
    yield started
    started.stop()


@pytest.fixture
def seen_by(page, server, tokens):
    """``seen_by("prof", "/people")`` is a page in a browser of their own, in which they have logged in by
    their token.
    """

    def opened(name, path="/"):
        new = page()
        log_in(new, server.url + path, token=tokens[name])
        return new

    opened.allowed = page.allowed
    return opened


def log_in(page, address, **fields):
    """Go there, by the login form that is in the way."""
    page.goto(address)
    assert page.title() == "Log in · polhode"
    labels = {"name": "Name", "password": "Password", "token": "Token from your course"}
    for name, value in fields.items():
        page.get_by_label(labels[name], exact=True).fill(value)
    page.get_by_role("button", name="Log in").click()
    page.locator("nav .me").wait_for()
    assert page.url == address


def heading(page):
    return page.get_by_role("heading", level=1).inner_text()


def told(page):
    return " ".join(page.locator("main").inner_text().split())


def found(page):
    return page.get_by_role("heading", level=2).first.inner_text()


def rows(page, table):
    """What the shown rows of a table's body say."""
    return [" ".join(row.split()) for row in page.locator(f"{table} > tbody > tr:visible").all_inner_texts()]


def post(server, token, source):
    """Submit with a token, as a notebook does; the id."""
    body = json.dumps({"source": source, "exercises": ["2"]}).encode()
    headers = {"Content-Type": "application/json", "Authorization": f"Bearer {token}"}
    address = f"{server.url}/v1/assignments/rigid-body/submissions"
    with urllib.request.urlopen(urllib.request.Request(address, body, headers), timeout=30) as answer:
        return json.load(answer)["id"]


@pytest.mark.parametrize("name", ["prof", "tutor", "ann"])
def test_first_by_token_then_by_a_password_of_ones_own(page, server, tokens, name):
    page.allowed.append("status of 422")
    page, password = page(), f"a polhode rolls for {name}"
    log_in(page, f"{server.url}/", token=tokens[name])
    page.locator("nav .me").click()
    page.get_by_label("New password (").fill(password)
    page.get_by_label("Repeat new password").fill("another password")
    page.get_by_role("button", name="Save password").click()
    page.get_by_role("alert").get_by_text("passwords do not match").wait_for()
    assert (
        page.evaluate("document.activeElement.name") == "again"
        and page.get_by_label("New password (").input_value() == password
    )
    page.get_by_label("Repeat new password").fill(password)
    page.get_by_role("button", name="Save password").click()
    page.get_by_text("✓ Password saved. Other browsers are logged out.").wait_for()
    page.get_by_role("button", name="Log out", exact=True).click()
    page.get_by_text("You are logged out.").wait_for()
    assert page.locator("nav .me").count() == 0
    page.get_by_label("Name").fill(name)
    page.get_by_label("Password", exact=True).fill(password)
    page.get_by_role("button", name="Log in").click()
    page.locator("nav .me").wait_for()
    shown = page.locator("nav a").all_inner_texts()
    assert ("People" in shown) == (name != "ann") and shown[-1] == (
        name if name == "ann" else f"{name}, {ROLES[name]}"
    )
    assert heading(page) == ("Assignments" if name == "ann" else "Course")


def test_a_wrong_password_is_told_at_the_form(page, server):
    page.allowed.append("status of 401")
    page = page()
    page.goto(f"{server.url}/login")
    page.get_by_label("Name").fill("ann")
    page.get_by_label("Password", exact=True).fill("not hers")
    page.get_by_role("button", name="Log in").click()
    assert (
        page.get_by_role("alert").inner_text().startswith("✗ ")
        and page.get_by_label("Name").input_value() == "ann"
    )
    assert page.get_by_label("Name").get_attribute("aria-describedby") == page.get_by_role(
        "alert"
    ).get_attribute("id")


def test_students_see_their_own_work_and_pages_that_say_no(seen_by, server, sent):
    seen_by.allowed.append("status of 403")
    page = seen_by("ann")
    for path in (*STAFF_ONLY, f"/submissions/{sent['ben']}", f"/submissions/{sent['ben']}/diff"):
        answer = page.goto(server.url + path)
        assert answer.status == 403 and heading(page) == "Permission denied", path
        assert (
            page.get_by_role("alert").inner_text() and "ben" not in page.locator("main").inner_text().split()
        )
    page.get_by_role("link", name="Home").click()
    page.locator("table[data-rows] tbody a").first.click()
    assert page.url.endswith(sent["ann"]) and page.get_by_text("Override score").count() == 0


def test_assistants_see_everything_and_may_not_decide(seen_by, server, sent):
    seen_by.allowed.append("status of 403")
    page = seen_by("tutor")
    for path in (*STAFF_ONLY[:-1], f"/submissions/{sent['ben']}"):
        assert page.goto(server.url + path).status == 200, path
        assert (
            page.locator("form[action$='/rules'], form[action$='/overrides'], form[action='/people']").count()
            == 0
        )
    for path in ("/people", f"{BASE}/rules", f"{BASE}/extensions", f"/submissions/{sent['ben']}/overrides"):
        page.goto(f"{server.url}{BASE}/regrades")
        with page.expect_navigation() as going:  # the page's own form, sent elsewhere
            page.evaluate(
                "path => { const form = document.querySelector('main form'); form.action = path;"
                " form.submit(); }",
                path,
            )
        assert going.value.status == 403 and heading(page) == "Permission denied", path


def test_a_roster_is_chosen_and_entered_and_its_token_logs_in(seen_by, page, server, tmp_path):
    prof, file = seen_by("prof", "/people"), tmp_path / "class.csv"
    file.write_text(
        "name,role,full_name,email,student_id\nzoe,student,Zoë Ågård,zoe@example.org,0042\nyan,former,,,\n"
    )
    prof.locator("summary", has_text="Import roster").click()
    prof.get_by_label("Roster file").set_input_files(file)
    prof.get_by_role("button", name="Preview import").click()
    prof.get_by_role("button", name="Import 2 people").click()
    prof.get_by_text("Imported 2 people.").wait_for()
    prof.get_by_label("Filter").fill("agard")
    assert rows(prof, "#people") == ["zoe Zoë Ågård student zoe@example.org 0042 0 –"]
    prof.locator("summary", has_text="Import roster").click()
    prof.get_by_label("Roster file").set_input_files(file)
    prof.get_by_role("button", name="Preview import").click()
    prof.get_by_label("Create a new login token").check()
    with prof.expect_download() as coming:
        prof.get_by_role("button", name="Import 2 people").click()
    given = dict(csv.reader(io.StringIO(coming.value.path().read_text())))
    assert set(given) == {"name", "zoe", "yan"}
    prof.get_by_role("status").get_by_text(
        "✓ Imported 2 people. The tokens are in the downloaded file."
    ).wait_for()
    assert (
        not prof.get_by_text("Nothing is imported yet").count()
        and not prof.get_by_role("button", name="Import").count()
    )
    log_in(page(), f"{server.url}{BASE}", token=given["zoe"])


def test_a_role_that_is_not_understood_must_be_confirmed(seen_by, tmp_path):
    prof, file = seen_by("prof", "/people"), tmp_path / "bad.csv"
    file.write_text("name,role\nzoe,queen\n")
    prof.locator("summary", has_text="Import roster").click()
    prof.get_by_label("Roster file").set_input_files(file)
    prof.get_by_role("button", name="Preview import").click()
    prof.get_by_label("The role “queen” means").select_option("student")
    prof.get_by_role("button", name="Preview again").click()
    prof.get_by_role("button", name="Import 1 person").click()
    prof.get_by_text("Imported 1 person.").wait_for()


def test_from_the_class_to_a_checks_students_to_a_submission_and_from_a_cause(seen_by, sent):
    page = seen_by("prof", f"{BASE}/class")
    page.get_by_role("link", name="Students", exact=True).click()
    page.get_by_role("link", name="check", exact=True).click()
    page.locator("#heat thead").get_by_role("link", name="rotational energy conserved").first.click()
    assert found(page).startswith("3 of ") and [row[:3] for row in rows(page, "#submissions")] == [
        "ann",
        "cle",
        "dan",
    ]
    page.locator("#submissions tr", has_text="cleo").locator("a[data-main]").click()
    assert (
        page.url.endswith(f"/submissions/{sent['cleo']}#check-2-energy")
        and "By cleo" in page.locator("main").inner_text()
    )
    page.get_by_role("link", name="Rigid", exact=False).first.click()
    page.locator("tr", has_text=OTHER.sentence).get_by_role("link", name="1 student").click()
    assert found(page).startswith("1 of ") and [row[:4] for row in rows(page, "#submissions")] == ["cleo"]
    page.set_viewport_size({"width": 390, "height": 900})
    page.go_back()
    links, cells = (
        page.locator(f"#causes tbody {cell}").evaluate_all(
            "all => all.map(one => one.getBoundingClientRect())"
        )
        for cell in ("th a", "td:nth-child(2)")
    )
    assert all(link["right"] <= cell["left"] for link, cell in zip(links, cells, strict=True)) and links
    page.go_forward()
    assert page.locator("main q").inner_text() == OTHER.sentence


def test_the_class_is_filtered_by_typing_and_gone_through_by_keys(seen_by, sent):
    page = seen_by("prof", f"{STUDENTS}?by=check")
    page.locator("button.keys").wait_for()
    page.keyboard.press("/")
    page.keyboard.type("BEN")
    assert [row.split()[0] for row in rows(page, "#heat")] == ["ben"]
    page.locator("#heat thead a").last.focus()
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.textContent") == "ben", "into the first cell that is shown"
    page.get_by_label("Filter").fill("✓")
    assert [row.split()[0] for row in rows(page, "#heat")] == ["ann", "ben", "dan"]
    page.evaluate("document.activeElement.blur()")
    for key, name in (("j", "ann"), ("j", "ben"), ("j", "dan"), ("k", "ben")):
        page.keyboard.press(key)
        assert page.evaluate("document.activeElement.textContent").strip().startswith(name), key
    page.keyboard.press("o")
    page.wait_for_url(f"**/submissions/{sent['ben']}")


def test_a_deadline_and_an_extension_are_set_and_taken_back(seen_by, server):
    seen_by.allowed.append("status of 422")
    page, overview = seen_by("prof", SETTINGS), seen_by("prof", f"{BASE}/class")
    page.get_by_label("Deadline (UTC)", exact=True).fill("2036-02-29T12:30")
    page.get_by_label("Grace period (minutes)").fill("90")
    page.get_by_role("button", name="Save deadline and limits").click()
    page.get_by_text("Deadline and limits saved.").wait_for()
    overview.reload()
    assert "Deadline: 2036-02-29 12:30 UTC, 90 min of grace; unlimited" in told(overview)
    assert page.locator(".announcement").inner_text() == "Deadline and limits saved."
    page.get_by_label("Name").fill("ann")
    page.get_by_label("New deadline (UTC)").fill("2020-03-07T12:30")
    page.get_by_label("Reason").fill("was ill for a week")
    page.get_by_role("button", name="Save extension").click()
    page.get_by_role("alert").get_by_text("this deadline is past").wait_for()
    assert page.get_by_label("Reason").input_value() == "was ill for a week", "nothing typed is lost"
    assert not page.locator(".announcement").inner_text(), "nothing is announced as saved beside an error"
    assert page.evaluate("document.activeElement.name") == "due"
    page.get_by_label("New deadline (UTC)").fill("2036-03-07T12:30")
    page.get_by_role("button", name="Save extension").click()
    page.get_by_text("Extensions saved.").wait_for()
    table = page.locator("table", has_text="Current extensions")
    assert re.search(r"ann\s+2036-03-07 12:30\s+was ill for a week\s+prof", table.inner_text())
    page.get_by_label("Name").fill("ann")
    page.get_by_role("button", name="Save extension").click()
    table.wait_for(state="detached")
    page.get_by_label("Deadline (UTC)", exact=True).fill("")
    page.get_by_role("button", name="Save deadline and limits").click()
    page.get_by_text("Deadline and limits saved.").wait_for()
    overview.reload()
    assert "Deadline: none; unlimited" in told(overview)


def test_points_by_hand_are_read_by_the_student_and_withdrawn(seen_by, sent, server):
    prof, ann = seen_by("prof", f"/submissions/{sent['ann']}"), seen_by("ann")
    prof.get_by_text("Override score").click()
    assert prof.get_by_label("Points").get_attribute("max") == "2"
    prof.get_by_label("Check").select_option("2-energy")
    assert prof.get_by_label("Points of 1").get_attribute("max") == "1"
    prof.get_by_label("Points").fill("1")
    prof.get_by_label("Reason (shown to the student)").fill(
        "the sign convention was not told in the notebook"
    )
    prof.get_by_role("button", name="Save override").click()
    prof.get_by_text("Override saved.").wait_for()
    assert "2 of 36 (graded 1)" in prof.locator("#points").inner_text()
    ann.goto(f"{server.url}/submissions/{sent['ann']}")
    told = ann.locator("#points").inner_text()
    assert (
        "the sign convention was not told in the notebook" in told
        and "prof" in told
        and "2 of 36 (graded 1)" in told
    )
    assert ann.locator("#points button").count() == 0
    prof.get_by_role("button", name="Withdraw the override of 2-energy").click()
    prof.get_by_text("Override withdrawn.").wait_for()
    ann.reload()
    told = ann.locator("#points").inner_text()
    assert "withdrawn by prof" in told and "1 of 36." in told
    prof.goto(f"{server.url}/audit?subject=ann")
    told = " ".join(prof.locator("tbody td:nth-child(3)").all_inner_texts())
    assert "overrode points of submission" in told and "withdrew an override of submission" in told


def test_a_checks_victims_are_graded_again_looked_at_and_let_count(seen_by, sent, server):
    page, ann = seen_by("tutor", f"{BASE}/regrades"), seen_by("ann", f"/submissions/{sent['ann']}")
    page.get_by_label("counted submissions that do not pass this check").check()
    page.get_by_label("Check", exact=True).select_option("2-energy")
    page.get_by_role("button", name="Regrade (preview)").click()
    page.wait_for_url("**/regrades/*-*")
    assert heading(page).startswith("Regrade of")
    assert "counted submissions that do not pass 2-energy" in page.locator("main").inner_text()
    page.evaluate("window.been = true")
    page.get_by_text("3 of 3 graded").wait_for()
    page.get_by_text("2 gain, 1 lose, 0 keep their points").wait_for()
    assert page.evaluate("window.been"), "told without being loaded again"
    assert (
        page.get_by_role("button", name="Apply").count() == 0
        and page.get_by_text("Only an instructor can apply the regrade.").is_visible()
    )
    lost = page.locator("[role=region][aria-label=Lose] tbody").inner_text()
    assert lost.startswith("dan") and "1 → 0" in lost and "✓ → –" in lost
    ann.reload()
    assert "1 of 36, +0 of 6 bonus points" in " ".join(ann.locator("main").inner_text().split())
    prof = seen_by("prof", page.url.removeprefix(server.url))
    prof.get_by_role("button", name="Apply").click()
    prof.locator("#live").get_by_text("✓ applied by prof").wait_for()
    ann.reload()
    assert "5 of 36, +0 of 6 bonus points" in " ".join(ann.locator("main").inner_text().split())
    assert "2, shown, regrade" in ann.locator("#gradings").inner_text()


def test_every_export_is_downloaded_and_can_be_read(seen_by):
    page = seen_by("prof", f"{BASE}/class")
    for link in ("CSV", "nbgrader", "Canvas", "Moodle"):
        with page.expect_download() as coming:
            page.get_by_role("link", name=link, exact=True).click()
        head, *lines = csv.reader(io.StringIO(coming.value.path().read_text("utf-8-sig"), newline=""))
        assert coming.value.suggested_filename.endswith(".csv") and {len(line) for line in lines} == {
            len(head)
        }
        assert any("ann" in line for line in lines), link
    with page.expect_download() as coming:
        page.get_by_role("link", name="JSON").click()
    assert {"ann", "ben"} <= {
        row["student"] for row in json.loads(coming.value.path().read_text())["students"]
    }
    with page.expect_download() as coming:
        page.get_by_role("link", name="all data (zip)").click()
    with zipfile.ZipFile(coming.value.path()) as archive:
        assert (
            archive.testzip() is None
            and "rigid-body/grades.csv" in archive.namelist()
            and len(archive.namelist()) > 5
        )


# the second one when the answer to the first replaces the page
TWO_CLICKS = """() => {
    const [first, second] = ["ann", "ben"].map(
        name => document.querySelector(`[aria-label="Cancel the grading of ${name}"]`),
    );
    addEventListener("pagehide", () => second.click());
    first.click();
}"""


def test_an_endless_loop_is_seen_cancelled_and_retried_by_clicks(seen_by, server, tokens, url):
    page = seen_by("tutor", "/queue")
    page.get_by_text("The queue is empty.").wait_for()  # the worker has started and graded
    page.evaluate("window.been = true")
    loop = post(server, tokens["ben"], LOOP)
    page.get_by_text("possibly an endless loop").wait_for()
    assert page.locator(f"table.going a[href='/submissions/{loop}']").inner_text() == "ben"
    assert page.locator(".stuck").inner_text().startswith("⏱ ")
    waiting = post(server, tokens["ann"], GOOD)
    page.get_by_role("heading", name="Waiting: 1").wait_for()
    assert page.evaluate("window.been"), "it tells by itself"
    page.get_by_role("button", name="Cancel the grading of ann").wait_for()
    page.evaluate(TWO_CLICKS)
    page.get_by_role("button", name="Retry grading the submission of ben").wait_for()
    assert page.get_by_text("cancelled by tutor").count() == 2
    page.get_by_role("button", name="Retry grading the submission of ann").click()
    page.get_by_role("heading", name="Failed or cancelled: 1").wait_for()
    ann = seen_by("ann", f"/submissions/{waiting}")
    ann.locator(".outcomes li.pass").first.wait_for(state="attached")  # folded, as its exercise passes
    assert sql(url, "SELECT count(*) FROM grading WHERE submission_id = %s", waiting) == [(2,)]


def test_a_student_submits_a_file_and_watches_its_grading(seen_by, tmp_path):
    seen_by.allowed.append("status of 422")
    page = seen_by("dan", BASE)
    wrong, right = tmp_path / "euler.pdf", tmp_path / "euler.py"
    wrong.write_text("%PDF")
    right.write_text(GOOD)
    page.get_by_label("Completed notebook or Python file").set_input_files(wrong)
    page.get_by_role("button", name="Submit").click()
    page.get_by_role("alert").wait_for()
    assert ".ipynb" in page.get_by_role("alert").inner_text() and page.url.endswith(BASE)
    page.get_by_label("Completed notebook or Python file").set_input_files(right)
    page.get_by_role("button", name="Submit").click()
    page.wait_for_url("**/submissions/*")
    page.locator(".outcomes").first.wait_for(state="attached")  # folded, as its exercise passes
    assert "euler.py" in page.locator("main").inner_text()
