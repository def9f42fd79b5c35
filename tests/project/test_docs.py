"""The docs are tested: every route, setting, check word, diagnosis code and word of the glossary is where a
reader looks for it.
"""

import importlib
import inspect
import re
import tomllib
from pathlib import Path

import pytest

from exercises.authoring.assignments.samples import samples
from exercises.authoring.codes import CODES
from exercises.authoring.mutants import mutation
from exercises.authoring.questions import author
from exercises.authoring.questions.question import Question
from polhode.judging import checks
from polhode.kinds import KINDS
from polhode.report.document import document
from service import app
from service.grading.grade import grade
from service.grading.submission import SizeLimits, Submission
from service.http import errors
from service.settings import Settings
from tests.support.assignments import known

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
    assert documented == CODES >= {*of_the_guest, *mutation.CODES}


GLOSSARY = """assignment, exercise, scene, check, outcome, verdict, margin, diagnosis, mistake, sample,
submission, grading, run, report, sandbox, guest / host, isolation level, scene end, system fault"""


@pytest.mark.parametrize("word", GLOSSARY.replace("\n", " ").split(", "))
def test_the_glossary_has_matplotlib(word):
    assert re.search(rf"^\| {re.escape(word)} \| .{{5,}} \|$", doc("README.md"), re.MULTILINE)


def examples():
    """The two files that the Python blocks of docs/authors.md make: a whole notebook, and all others one
    after the other.
    """
    blocks = re.findall(r"^```python\n(.*?)^```", doc("docs/authors.md"), re.MULTILINE | re.DOTALL)
    whole = next(block for block in blocks if "Radioactive decay" in block)
    return {"decay": whole, "falling": "\n\n".join(block for block in blocks if block is not whole)}


def test_the_whole_notebook_for_authors_is_short():
    text = examples()["decay"]
    assert (
        len(text.splitlines()) <= 120
        and text.count("mistake(") >= 12
        and text.count("notebook.exercise(") == 6
    )


@pytest.fixture(scope="module", params=["falling", "decay"])
def example(request, tmp_path_factory):
    """An assignment of docs/authors.md."""
    folder = tmp_path_factory.mktemp("docs") / request.param
    folder.mkdir()
    (folder / "assignment.py").write_text(examples()[request.param])
    with known(folder) as found:
        assert not found.invalid, found.invalid
        yield found.valid[request.param]


def graded(sample, assignment, sandbox):
    return document(grade(Submission(sample.source), assignment, sandbox, 1, sample.ask).report)


def test_the_example_for_authors_passes_its_own_checks(example, sandbox):
    right = next(iter(example.made_samples()))
    assert right.unexpected(graded(right, example, sandbox)) == []
    codes = {sample.code for sample in example.made_samples()} - {None}
    assert len(example.exercises) >= 6 and len(codes) >= 4 and codes <= documented_codes()


@pytest.mark.slow
def test_each_mistake_of_the_example_for_authors_is_named(example, sandbox):
    for sample in list(example.made_samples())[1:]:
        assert sample.unexpected(graded(sample, example, sandbox)) == [], sample.name


COMMON = "`solution`, `ask`, `truth`, `mistakes`, `uses` and `budget_s`"


def test_the_guide_for_authors_names_what_an_author_imports():
    for name in author.__all__:
        assert re.search(rf"`{name}\(", doc("docs/authors.md")), name
    modules = [importlib.import_module(f"exercises.authoring.kinds.{kind}") for kind in KINDS]
    made = [
        (f, inspect.signature(f))
        for module in modules
        for f in vars(module).values()
        if inspect.isfunction(f)
    ]
    kinds = {
        f.__name__: signature
        for f, signature in made
        if signature.return_annotation is Question and f.__name__[0] != "_"
    }
    assert len(kinds) >= len(KINDS)
    for kind, signature in kinds.items():
        sections = [
            text for text in doc("docs/authors.md").split("\n### ") if f"`{kind}`" in text.split("\n")[0]
        ]
        assert sections, kind
        for name in (p.name for p in signature.parameters.values() if p.kind is not p.VAR_KEYWORD):
            assert f"`{name}`" in sections[0] + COMMON, (kind, name)


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
    "page", [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))], ids=lambda page: page.name
)
def test_links_between_pages_lead_to_a_heading(page):
    for target in re.findall(r"\]\((?!http)([^)\s]+)\)", page.read_text()):
        name, _, anchor = target.partition("#")
        other = page.parent / name if name else page
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
