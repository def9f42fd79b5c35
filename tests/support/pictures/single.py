"""The pictures of a student's report, of a submission as its instructor sees it, and of the queue."""

from pathlib import Path
from uuid import UUID

from playwright.sync_api import Browser, Page

from service.store.queue import cancelling as gradings
from tests.support.database import entered, run, sql
from tests.support.pictures.browser import log_in, open_page, save, show, upper_part
from tests.support.pictures.demonstration import submit

STUDENTS = ("student-07", "student-11", "student-24")
SIGN = """\
def euler_eqs(t, w, I):
    I1, I2, I3 = I
    return np.array([
        (I2 - I3) * w[1] * w[2] / I1,
        (I3 - I1) * w[2] * w[0] / I2,
        (I2 - I1) * w[0] * w[1] / I3,
    ])
"""
RAISES = '''\
def euler_eqs(t, w, I):
    """Angular acceleration of a body without torques."""
    return -np.cross(I * w, w) / I


def animate_tumble(t, R, half):
    fig, ax = plt.subplots(subplot_kw={"projection": "3d"})
    box = Poly3DCollection(box_polys(half))
    ax.add_collection3d(box)

    def update(k):
        box.set_verts([face @ R[k].T for face in half])

    return FuncAnimation(fig, update, frames=len(t))
'''
ENDLESS = """\
def euler_eqs(t, w, I):
    return -np.cross(w, I * w) / I


def animate_precession(t, R, L):
    while True:
        pass
"""  # an animation has the longest time limit


def draw_report(browser: Browser, address: str, url: str, file: Path) -> Path:
    """Write the picture of a student's report: a sign error in Euler's equations, sent with exercises 2–5."""
    id = submit(url, STUDENTS[0], "week2.py", SIGN, ["2", "3", "4", "5"])
    with open_page(browser, width=1080, color_scheme="light") as page:
        _open_graded(page, address, entered(url, STUDENTS[0], None), id)
        return save(upper_part(page, ".exercises"), file)


def draw_submission(browser: Browser, address: str, url: str, file: Path) -> Path:
    """Write the picture of a submission for its instructor, down to its exercises."""
    id = submit(url, STUDENTS[1], "tuesday.py", RAISES, ["5"])
    with open_page(browser, width=1080, color_scheme="light") as page:
        _open_graded(page, address, entered(url, "prof", "instructor"), id)
        return save(upper_part(page, ".exercises"), file)


def draw_queue(browser: Browser, address: str, url: str, file: Path) -> Path:
    """Write the picture of the queue: an endless loop is running, one grading waits, one was cancelled."""
    with open_page(browser, color_scheme="light", height=600) as page:
        log_in(page, address, entered(url, "prof", "instructor"))
        page.goto(f"{address}/queue")
        *_, last = [submit(url, student, f"{student}.py", ENDLESS, ["6"]) for student in STUDENTS]
        ((grading,),) = sql(url, "SELECT id FROM grading WHERE submission_id = %s", last)
        run(url, lambda database: gradings.cancel(database, grading, "prof"))
        for shown in ("Running: 1", "Waiting: 1", "Failed or cancelled: 1", "possibly an endless loop"):
            page.get_by_text(shown).wait_for()
        return save(page.screenshot(full_page=True), file)


def _open_graded(page: Page, address: str, token: str, id: UUID) -> None:
    """Log in, and open a submission once it is graded."""
    log_in(page, address, token)
    page.goto(f"{address}/submissions/{id}")
    page.locator(".exercises").wait_for()  # the page shows the report as soon as it is there
    show(page, f"{address}/submissions/{id}")
