"""The pictures of docs/authors/: a notebook's report of the first mistake of each page's example."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from playwright.sync_api import Browser

from polhode.report import report_html
from service.grading.grade_file import GradedFile, GradeOptions, GradeRequest, grade_file, start_grader
from service.sandbox.isolation.select import choose, with_packages
from service.sandbox.sandbox import Sandbox
from tests.support import author_pages
from tests.support.assignments import known
from tests.support.pictures.browser import open_page, save, show

WIDTH, SEED = 760, 1
STYLE = "<meta charset='utf-8'><style>body{margin:12px;font-family:sans-serif}</style>"


def draw(browser: Browser, folder: Path) -> Iterator[Path]:
    """Write and yield the picture of each page; the examples are written into ``folder``."""
    sandbox = Sandbox(with_packages(choose("namespaces"), ["sympy"]))
    try:
        for page in author_pages.PAGES:
            file = folder / f"{page.stem}.html"
            file.write_text(STYLE + _report(page, folder, sandbox), encoding="utf-8")
            with open_page(browser, width=WIDTH, height=100, color_scheme="light") as shown:
                show(shown, file.as_uri())
                yield save(shown.screenshot(full_page=True), page.with_suffix(".png"))
    finally:
        sandbox.close()


def _report(page: Path, folder: Path, sandbox: Sandbox) -> str:
    with known(author_pages.write(page, folder)) as found:
        assignment = found.valid[page.stem]
        wrong = author_pages.wrong_samples(assignment)[0]
        submitted = folder / f"{page.stem}.py"
        submitted.write_text(wrong.source, encoding="utf-8")
        options = GradeOptions(assignment, SEED, formats=("svg",))
        graded = grade_file(start_grader(sandbox), options, GradeRequest(submitted, ("1",)))
    assert graded.report is not None, graded.why
    found = report_html.html(replace(graded.report, drawn=lambda name: _picture(graded, name)))
    return found.replace("<details>", "<details open>")


def _picture(graded: GradedFile, name: str) -> bytes | None:
    return graded.pictures.get(f"{name}.svg") or graded.pictures.get(f"{name}.png")
