"""The documentation site: its reference is complete, its links and commands are right, and its quick starts
run.
"""

import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from docs import site
from exercises.authoring.assignments.catalogue import load_catalogue
from service.app import ROUTERS
from service.cli.__main__ import COMMANDS, _parse
from service.settings import Settings
from tests.support import doc_commands
from tests.support.checkout import ROOT

PAGES = sorted((ROOT / "docs").rglob("*.md"))
QUICK_STARTS, TUTORIALS = (
    sorted((ROOT / "docs/start").iterdir()),
    sorted((ROOT / "docs/tutorials").glob("*.md")),
)
WITH_SERVER = {"student", "instructor"}


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """The staged pages of the site, by their paths in it."""
    folder = tmp_path_factory.mktemp("site") / "docs"
    site.stage(folder)
    return {str(path.relative_to(folder)): path.read_text() for path in folder.rglob("*.md")}


def navigation():
    sections = tomllib.loads((ROOT / "zensical.toml").read_text())["project"]["nav"]
    return [page for section in sections for pages in section.values() for page in pages]


@pytest.mark.slow
def test_every_page_is_in_the_navigation_once(pages):
    assert sorted(navigation()) == sorted(pages)


def anchors(text):
    """The anchors of a page, as Python-Markdown makes them of its headings."""
    headings = re.findall(r"^#+ (.*)$", re.sub(r"(?ms)^```.*?^```", "", text), re.MULTILINE)
    plain = (
        re.sub(r"[^\w\s-]", "", re.sub(r"\[(.*?)\]\(.*?\)", r"\1", heading)).strip().lower()
        for heading in headings
    )
    return {re.sub(r"[-\s]+", "-", heading) for heading in plain}


@pytest.mark.slow
def test_every_link_leads_to_a_page_of_the_site(pages):
    for name, text in pages.items():
        for target in re.findall(r"\]\((?!https?:|mailto:)([^)\s]+)\)", text):
            path, _, anchor = target.partition("#")
            place = (Path(name).parent / path).as_posix() if path else name
            place = str(Path(ROOT, place).resolve().relative_to(ROOT))
            assert place in pages or (ROOT / "docs" / place).is_file(), (name, target)
            assert not anchor or place not in pages or anchor in anchors(pages[place]), (name, target)


@pytest.mark.slow
def test_the_reference_is_complete(pages):
    assert all(f"## polhode {name}\n" in pages["reference/cli.md"] for name in COMMANDS)
    assert all(
        f"`POLHODE_{name.upper()}`" in pages["reference/settings.md"] for name in Settings.model_fields
    )
    routes = [
        (method, route.path) for router in ROUTERS for route in router.routes for method in route.methods
    ]
    assert len(routes) > 15
    assert all(f"## {method} {path}\n" in pages["reference/api.md"] for method, path in routes)
    checks = [check for assignment in load_catalogue()[0].values() for check in assignment.checks()]
    assert len(checks) > 200
    assert all(f"| `{check.id}` |" in pages["reference/checks.md"] for check in checks)
    functions = re.findall(r"^### (\w+)$", pages["reference/physics.md"], re.MULTILINE)
    assert {"euler_rhs", "motion", "Exact", "HeavyTop", "polhode"} <= set(functions)
    assert "(L. Euler, 1758; Landau & Lifshitz, Mechanics, §36)" in pages["reference/physics.md"]


@pytest.mark.slow
def test_a_bar_in_a_tables_code_has_no_backslash(pages):
    assert "| `max|Δ| = … (rtol=…, atol=…)`" in pages["checks.md"] and "max\\|Δ" not in pages["checks.md"]


def test_a_label_keeps_its_characters_in_markdown():
    assert site.text("a_b*c of ``x|y`` and |L|") == r"a\_b\*c of `x|y` and \|L\|"


@pytest.mark.parametrize("page", [ROOT / "README.md", *PAGES], ids=lambda page: page.name)
def test_commands_of_the_documentation_have_valid_arguments(page, capsys):
    for line in doc_commands.polhode_lines(page):
        arguments = shlex.split(line)[1:]
        try:
            _parse(arguments)
        except SystemExit as ended:
            assert ended.code == 0, (line, capsys.readouterr().err)


@pytest.mark.parametrize("page", QUICK_STARTS, ids=lambda page: page.stem)
def test_a_quick_start_fits_on_a_screen(page):
    assert len(page.read_text().splitlines()) <= 50


@pytest.mark.parametrize("page", [*QUICK_STARTS, *TUTORIALS], ids=lambda page: page.stem)
def test_what_is_explained_beside_a_command_is_a_comment(page):
    copied = re.findall(r"^ *```text\n(.*?)^ *```", page.read_text(), re.MULTILINE | re.DOTALL)
    assert not re.findall(r"\S {2,}[^# ].*", "".join(copied))


@pytest.mark.slow
@pytest.mark.parametrize("page", [*QUICK_STARTS, *TUTORIALS], ids=lambda page: page.stem)
def test_the_commands_of_a_quick_start_run_as_they_stand(page, tmp_path):
    (tmp_path / "submissions").mkdir()
    for place in ("mine.py", "submissions/right.py"):
        shutil.copy(ROOT / "exercises/rigid_body/samples/right_terms.py", tmp_path / place)
    example = "docs/tutorials/kepler"  # which a clone has
    shutil.copytree(ROOT / example, tmp_path / example, ignore=shutil.ignore_patterns("__pycache__"))
    doc_commands.run(page, tmp_path, server=page.stem in WITH_SERVER)


@pytest.mark.slow
def test_the_site_is_built_and_loads_nothing_from_other_hosts():
    if not Path(sys.executable).with_name("zensical").exists():
        pytest.skip("the generator is not installed: make .venv/docs")
    subprocess.run([sys.executable, "-m", "docs.site"], cwd=ROOT, check=True)
    for page in navigation():
        html = site.BUILT.joinpath(page).with_suffix(".html").read_text()
        loaded = re.findall(
            r"<(?:script|img|iframe)\b[^>]*\bsrc=[\"']?([^\"' >]+)|<link\b[^>]*\bhref=[\"']?([^\"' >]+)", html
        )
        assert not [one for one in loaded if "".join(one).startswith(("http", "//"))], page
    assert (site.BUILT / "search.json").stat().st_size > 100_000
