"""The page of a submission follows its grading, without a reload by hand, after an upload; the same file
again asks first.
"""

import pytest

from service.store.queue import runs
from tests.support.database import entered, run, sql
from tests.support.submissions import claim, grade

pytestmark = pytest.mark.slow  # tests/service/http/test_live_updates.py has the events

DROP = """files => {
    const dataTransfer = new DataTransfer();
    for (const [name, content] of files) dataTransfer.items.add(new File([content], name));
    const drop = new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true });
    document.querySelector(".upload").dispatchEvent(drop);
}"""


def test_an_upload_is_followed_to_its_report_and_asks_before_it_is_repeated(page, application, url, tmp_path):
    file = tmp_path / "mine.py"
    file.write_text("def euler_eqs(t, w, I):\n    return w\n")
    page = page()
    page.goto(f"{application.url}/assignments/rigid-body")
    page.get_by_label("Token from your course").fill(entered(url, "ann"))
    page.get_by_role("button", name="Log in").click()
    page.get_by_label("Completed notebook").set_input_files(file)
    page.get_by_role("button", name="Submit").click()
    page.get_by_text("Queued, position 1.").wait_for()
    ((submission, grading),) = sql(url, "SELECT submission_id, id FROM grading")
    claimed = claim(url, grading)
    run(url, lambda database: runs.heartbeat(database, claimed, "playing", 2, 5))
    page.get_by_text("Running scene 2 of 5.").wait_for()
    assert page.locator(".announcement").inner_text() == "Submitted.", (
        "the stream of events does not clear it"
    )
    notice, result = (page.locator(one).bounding_box() for one in (".announcement", ".status"))
    assert notice["y"] + notice["height"] <= result["y"], "it covers nothing"
    assert page.get_by_role("progressbar").get_attribute("max") == "5"
    sql(url, "UPDATE run SET ended_at = now(), end_reason = 'lost'")
    run(url, lambda database: grade(database, submission, {"2-energy": "✓"}))
    # folded, as its exercise passes
    page.get_by_text("rotational energy conserved").wait_for(state="attached")
    assert not page.locator("[data-progress]").count()
    page.goto(f"{application.url}/assignments/rigid-body")
    page.evaluate(DROP, [["a.py", ""], ["b.py", ""]])
    page.get_by_role("alert").get_by_text("Drop one file.").wait_for()
    page.evaluate(DROP, [["mine.py", file.read_text()]])
    assert not page.get_by_role("alert").count()
    page.get_by_role("button", name="Submit").click()
    question = page.get_by_role("alert")
    assert "You submitted the same code on" in question.inner_text()
    assert (
        question.get_by_role("link", name="open its report").get_attribute("href")
        == f"/submissions/{submission}"
    )
    assert sql(url, "SELECT count(*) FROM submission") == [(1,)]
    page.get_by_role("button", name="Submit again").click()
    page.get_by_text("Queued, position").wait_for()
    assert sql(url, "SELECT count(*) FROM submission") == [(2,)]
