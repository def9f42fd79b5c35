"""Draw the pictures of docs/pages.md from a running demonstration: ``python -m tests.support.page_images``.

Start ``make demo`` first and wait until the queue is empty; POLHODE_DATA is its folder, by default .demo. The
pictures are of a second server on its database, on which people log in. ``--width 390 --folder DIR --whole``
shows whole pages as on a phone.
"""

import argparse
import io
import os
import shutil
import time
from pathlib import Path

from PIL import Image
from playwright.sync_api import sync_playwright

from service.cli.database import database_url
from service.settings import Settings
from service.store import regrades
from service.store.course import comments
from tests.support.app import App
from tests.support.database import entered, run, sql

FOLDER = Path(__file__).parents[2] / "docs" / "pages"
BASE = "/assignments/rigid-body"
HEIGHT, COLOURS = 900, 192
COMMENT = "Compare the sign of each component with Euler's equations in section 2."
SCROLLED = """async () => {
    const height = document.documentElement.scrollHeight;
    for (let y = 0; y < height; y += 600) { scrollTo(0, y); await new Promise(r => setTimeout(r, 80)); }
    const loaded = image => image.complete || !image.checkVisibility()
        || new Promise(r => { image.onload = image.onerror = r; });
    await Promise.all([...document.images].map(loaded));
    scrollTo(0, 0);
}"""
# A student whose submission of all exercises failed and who later submitted one that passed.
CHOSEN = """
SELECT p.name, min(s.id::text) FILTER (WHERE r.score < r.max_score),
  min(s.id::text) FILTER (WHERE r.score = r.max_score)
FROM submission s JOIN person p ON p.id = s.person_id JOIN grading g ON g.submission_id = s.id
  AND g.number = 1
    JOIN result r ON r.grading_id = g.id JOIN assignment x ON x.id = s.assignment_id
WHERE x.slug = 'rigid-body' AND starts_with(p.name, 'student-') AND r.report IS NOT NULL
GROUP BY p.name HAVING bool_or(r.score = r.max_score AND r.score > 30) AND bool_or(r.score < r.max_score
  AND r.score > 1)
ORDER BY p.name LIMIT 1
"""


def main() -> None:
    """Draw every page in light and dark."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", type=Path, default=FOLDER)
    parser.add_argument("--width", type=int, default=1280)
    parser.add_argument("--whole", action="store_true", help="whole pages instead of their upper part")
    parser.add_argument("--only", nargs="*", help="names of pages; default: all")
    arguments = parser.parse_args()
    os.environ.setdefault("POLHODE_DATA", ".demo")
    arguments.folder.mkdir(exist_ok=True)
    with database_url(Settings()) as url:
        student, pages = prepare(url)
        tokens = {"instructor": entered(url, "prof", "instructor"), "student": entered(url, student, None)}
        server = App(database_url=url)
        try:
            draw(server.url, tokens, pages, arguments)
        finally:
            server.stop()


def prepare(url):
    """Enter a comment and a regrade once. Return the student's name, and (who, address) of every page by its
    name.
    """
    ((student, failed, passed),) = sql(url, CHOSEN)
    if not sql(url, "SELECT 1 FROM source_comment"):
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


def wait_for_gradings(url):
    """Return when the running demonstration has graded everything."""
    while sql(
        url,
        "SELECT 1 FROM grading a LEFT JOIN result r ON r.grading_id = a.id WHERE r.grading_id IS NULL"
        " LIMIT 1",
    ):
        time.sleep(2)


def draw(address, tokens, pages, arguments):
    """Write NAME-light.png and NAME-dark.png of each page."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox", "--disable-gpu"]
        )
        for scheme in ("light", "dark"):
            for who, token in tokens.items():
                context = browser.new_context(
                    viewport={"width": arguments.width, "height": HEIGHT},
                    color_scheme=scheme,
                    reduced_motion="reduce",
                    locale="en-GB",
                )
                page = context.new_page()
                page.goto(f"{address}/login")
                page.get_by_label("Token from your course").fill(token)
                page.get_by_role("button", name="Log in").click()
                page.locator("nav .me").wait_for()
                for name, (reader, path) in pages.items():
                    if reader == who and (not arguments.only or name in arguments.only):
                        page.goto(address + path)
                        page.evaluate(SCROLLED)
                        if "#" in path:
                            page.evaluate("document.querySelector(location.hash).scrollIntoView()")
                        page.wait_for_timeout(300)
                        save(
                            page.screenshot(full_page=arguments.whole),
                            arguments.folder / f"{name}-{scheme}.png",
                        )
                context.close()
        browser.close()


def save(picture, file):
    """Write a picture with so few colours that it is small."""
    image = Image.open(io.BytesIO(picture)).convert("RGB")
    image.quantize(COLOURS, dither=Image.Dither.NONE).save(file, optimize=True)
    print(file, file.stat().st_size)


if __name__ == "__main__":
    main()
