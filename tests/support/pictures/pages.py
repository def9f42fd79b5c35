"""The pictures of docs/pages.md: the upper part of each page in light and dark."""

from collections.abc import Iterator
from pathlib import Path

from playwright.sync_api import Browser

from service.store.course import comments, regrades
from tests.support.database import entered, run, sql
from tests.support.pictures.browser import log_in, open_page, save, show
from tests.support.pictures.demonstration import wait_for_gradings

BASE = "/assignments/rigid-body"
COMMENT = "Compare the sign of each component with Euler's equations in section 2."
# A student whose submission of all exercises failed and who later submitted one that passed.
CHOSEN = """
SELECT p.name, min(s.id::text) FILTER (WHERE r.score < r.max_score),
  min(s.id::text) FILTER (WHERE r.score = r.max_score)
FROM submission s JOIN person p ON p.id = s.person_id JOIN grading g ON g.submission_id = s.id
    JOIN result r ON r.grading_id = g.id JOIN assignment x ON x.id = s.assignment_id
WHERE x.slug = 'rigid-body' AND starts_with(p.name, 'student-') AND r.report IS NOT NULL AND NOT g.preview
GROUP BY p.name HAVING bool_or(r.score = r.max_score AND r.score > 30) AND bool_or(r.score < r.max_score
  AND r.score > 1)
ORDER BY p.name LIMIT 1
"""


def draw(browser: Browser, address: str, url: str, folder: Path) -> Iterator[Path]:
    """Write and yield NAME-light.png and NAME-dark.png of each page."""
    student, pages = prepare(url)
    tokens = {"instructor": entered(url, "prof", "instructor"), "student": entered(url, student, None)}
    folder.mkdir(exist_ok=True)
    for scheme in ("light", "dark"):
        for who, token in tokens.items():
            with open_page(browser, color_scheme=scheme) as page:
                log_in(page, address, token)
                for name, (reader, path) in pages.items():
                    if reader == who:
                        show(page, address + path)
                        if "#" in path:
                            page.evaluate("document.querySelector(location.hash).scrollIntoView()")
                            page.wait_for_timeout(300)
                        yield save(page.screenshot(), folder / f"{name}-{scheme}.png")


def prepare(url: str) -> tuple[str, dict[str, tuple[str, str]]]:
    """Enter a comment and a regrade. Return the student's name, and (who, address) of each page by name."""
    ((student, failed, passed),) = sql(url, CHOSEN)
    run(url, lambda database: comments.write(database, failed, "prof", cell=1, line=6, comment=COMMENT))
    run(
        url,
        lambda database: regrades.create(
            database, "rigid-body", regrades.BEST, "prof", description="everybody's counted submission"
        ),
    )
    wait_for_gradings(url)
    return student, {
        "course": ("student", "/"),
        "assignment": ("student", BASE),
        "report-failed": ("student", f"/submissions/{failed}"),
        "report-passed": ("student", f"/submissions/{passed}"),
        "source": ("student", f"/submissions/{failed}#source"),
        "class": ("instructor", f"{BASE}/class"),
        "students": ("instructor", f"{BASE}/class/students"),
        "checks": ("instructor", f"{BASE}/class/checks"),
        "submissions": ("instructor", f"{BASE}/class/submissions?check=2-motion&state=not-pass"),
        "regrades": ("instructor", f"{BASE}/regrades"),
        "settings": ("instructor", f"{BASE}/class/settings"),
        "person": ("instructor", f"/person?name={student}"),
        "reference": ("instructor", "/reference"),
    }
