"""The docs are tested: every route, setting, check word, diagnosis code and word of the glossary is where a
reader looks for it.
"""

import re
import tomllib
from pathlib import Path

import pytest

from exercises.authoring.assignments.samples import samples
from exercises.authoring.diagnosis_codes import CODES
from polhode.judging import checks
from service import app
from service.grading.submission import SizeLimits
from service.http import errors
from service.settings import Settings

ROOT = Path(__file__).parents[2]


def doc(name):
    return (ROOT / name).read_text()


def sources(*folders):
    return "\n".join(
        p.read_text() for f in folders for p in (ROOT / f).rglob("*.py") if "samples" not in p.parts
    )


def test_every_route_is_documented():
    told = doc("docs/http.md")
    paths = [r.path for router in (*app.ROUTERS, *app.PAGES) for r in router.routes]
    assert len(paths) > 10
    for path in paths:
        assert f"`{path}`" in told or f" {path}`" in told or path == "/", path


def test_every_problem_is_documented():
    raised = set(
        re.findall(r"(?:Problem\(\s*\d+, |SubmissionRejected\()\"([a-z-]+)\"", sources("service"))
    ) | set(errors.BY_STATUS.values())
    for kind in raised | set(errors.TITLES):
        assert f"`{kind}`" in doc("docs/http.md"), kind
    assert SizeLimits().source == 256 * 1024 and "256 KiB" in doc("docs/http.md")


def test_every_setting_is_documented():
    for name in Settings.model_fields:
        assert f"`POLHODE_{name.upper()}`" in doc("docs/settings.md"), name
    used = set(re.findall(r"POLHODE_[A-Z_]+", sources("service") + doc("Makefile") + doc("Dockerfile")))
    assert used == {u for u in used if u in doc("docs/settings.md")}


def test_every_check_word_is_documented():
    words = [
        n for n in ("close", "within", "conserved", "below", "holds", "shows") if callable(getattr(checks, n))
    ]
    for word in words:
        assert f"| `{word}` |" in doc("docs/checks.md")


def documented_codes():
    return set(
        re.findall(r"^\| `([a-z-]+)` \|", doc("docs/checks.md").split("## Diagnosis codes")[1], re.MULTILINE)
    )


def test_every_diagnosis_code_is_documented_and_every_documented_one_has_a_source(rigid_body):
    documented = documented_codes()
    code = sources("exercises", "service")
    for name in documented:
        assert f'"{name}"' in code, name
    named = {code for s in samples(rigid_body) for code in s.codes}
    assert named <= documented
    assert len(named) >= 30
    of_the_guest = {"missing-function", "syntax-error", "raises", "timeout", "memory", "not-deterministic"}
    assert documented == CODES >= of_the_guest


GLOSSARY = """assignment, exercise, scene, check, outcome, verdict, margin, diagnosis, mistake, sample,
submission, grading, run, report, sandbox, guest / host, isolation level, scene end, system fault"""


@pytest.mark.parametrize("word", GLOSSARY.replace("\n", " ").split(", "))
def test_the_glossary_has_matplotlib(word):
    assert re.search(rf"^\| {re.escape(word)} \| .{{5,}} \|$", doc("README.md"), re.MULTILINE)


def test_links_and_folders_of_the_readme_exist():
    for target in re.findall(r"\]\((?!http)([^)]+)\)", doc("README.md")):
        assert (ROOT / target).exists(), target
    for folder in re.findall(r"^\| `([a-z/]+)/` \|", doc("README.md"), re.MULTILINE):
        assert (ROOT / folder).is_dir(), folder


def anchors(page):
    """The anchors that GitHub gives the headings of a page."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(), re.MULTILINE)
    return {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize(
    "page", [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))], ids=lambda page: page.name
)
def test_links_between_pages_lead_to_a_heading(page):
    for target in re.findall(r"\]\((?!http)([^)\s]+)\)", page.read_text()):
        name, _, anchor = target.partition("#")
        other = page.parent / name if name else page
        if other.parent.name == "reference":  # made by docs.site, whose tests follow these links
            continue
        assert other.exists(), target
        assert not anchor or anchor in anchors(other), target


def test_nothing_names_a_package_registry_and_no_page_names_another_host():
    locks = sorted((ROOT / "requirements").iterdir())
    assert [lock.name for lock in locks] == [
        f"{name}.lock" for name in ("docs", "installer", "release", "runtime", "test")
    ]
    for lock in locks:
        assert "://" not in lock.read_text(), lock
    for page in [*(ROOT / "service/pages/templates").iterdir(), *(ROOT / "service/pages/static").iterdir()]:
        assert b"://" not in page.read_bytes(), page


def test_the_changelog_has_an_entry_for_this_version():
    version = tomllib.loads(doc("pyproject.toml"))["project"]["version"]
    assert f"\n## {version}" in doc("CHANGELOG.md")
