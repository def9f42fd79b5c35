"""polhode new-assignment: the file it makes works everywhere, and it makes all or nothing."""

import json
import os
import re
import shutil
import subprocess
import sys
import urllib.request
from pathlib import Path

import nbformat
import pytest

from service.cli.__main__ import main
from service.cli.authoring.new_assignment import TEMPLATE, CannotScaffold, scaffold
from service.grading.grade import grade
from service.grading.submission import Submission
from tests.project.test_docs import documented_codes
from tests.support import command_line
from tests.support.asgi import visit
from tests.support.assignments import copied, known
from tests.support.checkout import ROOT
from tests.support.course_shape import written
from tests.support.http_client import Browser
from tests.support.kit import environment, installed
from tests.support.limits import largest_file

TITLE = 'The "driven" pendulum: it\'s \\ {{SERVER}} <i>ω</i> \\u0041 $x_1$'


@pytest.fixture
def course(tmp_path):
    """A folder with an assignment made by the command, which this process knows; ruff takes it for the
    repository's.
    """
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    with known(tmp_path / "exercises"):
        made = command_line.polhode("new-assignment", "driven-pendulum", "--title", TITLE)
    assert made.returncode == 0, made.stderr
    folder = tmp_path / "exercises" / "driven_pendulum"
    assert made.stdout == f"created {folder}\nnext: polhode verify {folder}\n"
    with known(tmp_path / "exercises"):
        yield tmp_path / "exercises"


LISTED = (
    f"driven-pendulum  {TITLE}  (version 1)\n  1  The period of a pendulum: period\n  2  The damped"
    " oscillator: displacement\n"
)
VERIFIED = "driven-pendulum: 7 of 7 samples as expected on 4 seeds, 4 checks\n"


def submissions(course):
    """All right solutions, and those with a mistake in exercise 1, as source texts."""
    with known(course) as found:
        samples = {s.name: s.source for s in found.valid["driven-pendulum"].made_samples()}
    return [samples["right_all.py"], samples["wrong_1_1_missing_term.py"]]


@pytest.mark.slow
def test_it_is_verified_listed_and_graded(course, polhode, tmp_path):
    told = polhode("verify", "driven-pendulum")
    assert told.returncode == 0 and told.stdout.endswith(VERIFIED), told
    assert LISTED in polhode("assignments").stdout
    for name, source in zip(("right.py", "wrong.py"), submissions(course), strict=True):
        (tmp_path / name).write_text(source)
    right, wrong = (
        polhode("grade", tmp_path / name, "--assignment", "driven-pendulum")
        for name in ("right.py", "wrong.py")
    )
    assert (right.returncode, wrong.returncode) == (0, 1)
    assert "10 of 10 points" in right.stdout and "missing-term" in wrong.stdout


def test_it_is_a_declaration_beside_its_notebook_and_its_right_solutions_pass(course, sandbox):
    assert {file.name for file in (course / "driven_pendulum").glob("*.*")} == {
        "assignment.py",
        "notebook.ipynb",
    }
    right, wrong = submissions(course)
    with known(course) as found:
        reports = [
            grade(Submission(source), found.valid["driven-pendulum"], sandbox, 1).report
            for source in (right, wrong)
        ]
    assert reports[0].passed, reports[0].text()
    assert {d.code for o in reports[1].outcomes() for d in o.diagnosis} == {"missing-term"}


def test_it_passes_the_repositorys_lint(course):
    ours = f"src = ['{ROOT}', '{ROOT}/exercises/kit']"
    for command in (["check"], ["format", "--check"]):
        ruff = [Path(sys.executable).parent / "ruff", *command, "--no-cache", "--config", ours, course]
        told = subprocess.run(ruff, cwd=course.parent, capture_output=True, text=True, check=False)
        assert told.returncode == 0, told.stdout


@pytest.fixture(scope="module")
def tree(tmp_path_factory):
    """A copy of the repository with an assignment more, made by the command."""
    tree = tmp_path_factory.mktemp("tree")
    for name in ("exercises", "reference", "service", "tests", "docs", "requirements"):
        shutil.copytree(ROOT / name, tree / name, ignore=shutil.ignore_patterns("__pycache__", "attacks"))
    for name in (
        "pyproject.toml",
        "Makefile",
        "Dockerfile",
        "action.yml",
        *ROOT.glob("*.md"),
        *ROOT.glob("*.cff"),
    ):
        shutil.copy(ROOT / name, tree)
    made = inside(tree, "-m", "service.cli", "new-assignment", "driven-pendulum", "--title", TITLE)
    assert made.returncode == 0, made.stderr
    assert (
        made.stdout == f"created {tree}/exercises/driven_pendulum\nnext: polhode verify"
        f" {tree}/exercises/driven_pendulum\n"
    )
    return tree


def inside(tree, *arguments):
    environment = os.environ | {"PYTHONPATH": f"{tree}{os.pathsep}{tree / 'exercises' / 'kit'}"}
    return subprocess.run(
        [sys.executable, *map(str, arguments)],
        cwd=tree,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.slow
def test_in_the_repository_it_is_verified_and_listed(tree):
    told = inside(tree, "-m", "service.cli", "verify", "driven-pendulum")
    assert told.returncode == 0 and told.stdout.endswith(VERIFIED), told
    assert LISTED in inside(tree, "-m", "service.cli", "assignments").stdout


@pytest.mark.slow
def test_it_passes_the_repositorys_lint_and_tests(tree):
    programs = Path(sys.executable).parent
    for command in (
        [programs / "ruff", "check", "--no-cache", "exercises"],
        [programs / "ruff", "format", "--check", "--no-cache", "exercises"],
    ):
        told = subprocess.run(command, cwd=tree, capture_output=True, text=True, check=False)
        assert told.returncode == 0, told.stdout
    contracts = "from importlinter.cli import lint_imports_command; lint_imports_command()"
    assert inside(tree, "-c", contracts).returncode == 0
    files = (
        "tests/exercises/authoring/assignments/test_assignment.py",
        "tests/exercises/rigid_body/test_notebook.py",
        "tests/project/test_docs.py",
    )
    tested = inside(tree, "-m", "pytest", "-p", "no:cacheprovider", *files)
    assert tested.returncode == 0, tested.stdout


KERNEL = """
import json, sys
sys.path.insert(0, "kit")
import polhode
names = {"polhode": polhode}
exec(open(sys.argv[1]).read(), names)
report = eval('polhode.check("1", assignment="driven-pendulum")', names)
assert "exercises" not in sys.modules
print(repr(report))
"""


@pytest.fixture
def kits_home(course):
    """The folder beside which a kit lies that was made while the assignment is known."""
    return installed(course.parent, "driven-pendulum").parent


@pytest.mark.slow
def test_its_public_side_is_in_the_kit_and_gives_the_servers_lines(course, kits_home, polhode):
    home = kits_home / "cache" / "polhode" / "assignments" / "driven_pendulum"
    assert {p.name for p in home.iterdir()} == {
        "course",
        "made.json",
        "plays.py",
        "public.json",
        "truth.npz",
    }
    file = kits_home / "wrong.py"
    file.write_text(f"import numpy as np\n{submissions(course)[1]}")
    command = [sys.executable, "-P", "-c", KERNEL, str(file)]
    here = subprocess.run(
        command,
        cwd=kits_home,
        capture_output=True,
        text=True,
        check=False,
        env=environment(kits_home / "kit"),
    )
    assert here.returncode == 0, here.stderr
    served = polhode("grade", file, "--assignment", "driven-pendulum").stdout.splitlines()
    lines = [line for line in here.stdout.splitlines() if line[:1] in "✓✗"]
    assert [line[0] for line in lines] == ["✗"] and set(lines) <= set(served)


CHECKS = ["1-value", "1-new-value"]


@pytest.fixture
def course_with_a_broken_one(tmp_path):
    scaffold("driven-pendulum", TITLE, tmp_path / "course")
    (copied(tmp_path / "course", "broken_one") / "notebook.ipynb").unlink()
    return tmp_path / "course"


def test_it_has_pages_and_a_broken_one_costs_only_itself(course_with_a_broken_one, database_url):
    addresses = (
        "/v1/assignments",
        "/v1/assignments/driven-pendulum",
        "/readyz",
        "/",
        "/assignments/driven-pendulum",
    )
    refused = (
        "/v1/assignments/broken-one",
        "/assignments/broken-one",
        "/v1/assignments/broken-one/notebook.ipynb",
    )
    with known(course_with_a_broken_one):
        everything, one, ready, *pages, api, page, notebook = visit(database_url, *addresses, *refused)
    slugs = {assignment["slug"] for assignment in everything.json()}
    assert slugs >= {"rigid-body", "driven-pendulum"} and "broken-one" not in slugs
    assert one.json()["title"] == TITLE and [c["id"] for c in one.json()["exercises"][0]["checks"]] == CHECKS
    assert ready.json()["checks"]["assignments"] == "broken: broken-one"
    assert all(p.status_code == 200 and "<i>ω" not in p.text and "&lt;i&gt;ω" in p.text for p in pages)
    assert {p.status_code for p in (api, page, notebook)} == {503} and api.json()["type"].endswith(
        ":assignment-broken"
    )


@pytest.mark.slow
def test_a_server_serves_it_and_a_broken_one_costs_only_itself(
    tmp_path, course_with_a_broken_one, new_server, database_url
):
    course = str(course_with_a_broken_one)
    written(course_with_a_broken_one / "course", "random.py", "")
    server = new_server(
        tmp_path / "data", POLHODE_DATABASE_URL=database_url, POLHODE_WORKERS="1", POLHODE_ASSIGNMENTS=course
    )
    browser = Browser(server)

    def told(path):
        return json.loads(browser.open(path)[1])

    document = told("/v1/assignments/driven-pendulum")
    assert document["title"] == TITLE and [c["id"] for c in document["exercises"][0]["checks"]] == CHECKS
    slugs = {a["slug"] for a in told("/v1/assignments")}
    assert slugs >= {"rigid-body", "driven-pendulum"} and "broken-one" not in slugs
    checks = told("/readyz")["checks"]
    assert checks["assignments"] == "broken: broken-one"
    assert "random.py has the name of a module of the standard library" in checks["course"]
    assert "random.py has the name of a module of the standard library" in server.log.read_text()
    notebook = told(document["notebook"])
    assert 'polhode.connect(SERVER, assignment="driven-pendulum")' in "".join(notebook["cells"][2]["source"])
    assert server.url in "".join(notebook["cells"][2]["source"])

    sent = submit(server, "driven-pendulum", submissions(course_with_a_broken_one)[1])
    assert sent["report"]["score"] == 0
    for page in (
        f"/submissions/{sent['id']}",
        "/",
        "/assignments/driven-pendulum",
        "/assignments/driven-pendulum/class",
    ):
        status, text = browser.open(page)
        assert status == 200 and "<i>ω" not in text and "Traceback" not in text
    assert "sweep.svg" not in browser.open(f"/submissions/{sent['id']}")[1]  # it has none

    for path in (
        "/v1/assignments/broken-one",
        "/assignments/broken-one",
        "/v1/assignments/broken-one/notebook.ipynb",
    ):
        assert browser.open(path)[0] == 503
    with pytest.raises(urllib.error.HTTPError) as caught:
        submit(server, "broken-one", "def oscillator(): ...")
    assert caught.value.code == 503 and json.load(caught.value)["type"].endswith(":assignment-broken")
    assert "assignment broken-one: notebook.ipynb is missing" in server.log.read_text()


def submit(server, slug, source):
    headers = {"Content-Type": "application/json", "Prefer": "wait=30"}
    request = urllib.request.Request(
        f"{server.url}/v1/assignments/{slug}/submissions", json.dumps({"source": source}).encode(), headers
    )
    with urllib.request.urlopen(request, timeout=60) as answer:
        return json.load(answer)


def test_the_templates_codes_are_documented():
    codes = re.findall(r'mistake\(\s*"([a-z-]+)"', (TEMPLATE / "assignment.py").read_text())
    assert len(codes) == 5 and set(codes) <= documented_codes()


@pytest.mark.parametrize(
    "title", [TITLE, "'", '"', "\\", "\\N{BULLET}", "{0} %s {{KIT_URL}}", "# ``` </script> é 漢 𝄞", "x" * 100]
)
def test_any_title_stands_as_it_is(tmp_path, title):
    folder = scaffold("driven-pendulum", title, tmp_path)
    with known(folder) as found:
        assignment = found.valid["driven-pendulum"]
        notebook = assignment.notebook()
    assert assignment.title == title
    nbformat.validate(nbformat.reads(notebook, as_version=nbformat.NO_CONVERT))
    assert notebook.count("{{SERVER}}") == notebook.count("{{KIT_URL}}") == 1


SLUGS = [
    "",
    "-",
    "Pendulum",
    "a_b",
    "a--b",
    "a-",
    "1a",
    "a/b",
    "../a",
    "a.b",
    "ä",
    "class",
    "a" * 61,
    "rigid-body",
    "authoring",
    "kit",
    "a\n",
]


@pytest.mark.parametrize("slug", SLUGS)
def test_what_is_no_slug_or_is_taken_makes_nothing(tmp_path, capsys, slug):
    assert main(["new-assignment", "--into", str(tmp_path), "--", slug]) == 2
    assert capsys.readouterr().err.startswith("polhode: ") and not list(tmp_path.iterdir())


def test_nothing_is_overwritten(tmp_path):
    for make in (
        lambda path: path.mkdir(),
        lambda path: path.symlink_to("nowhere"),
        lambda path: path.with_suffix(".py").touch(),
    ):
        into = tmp_path / str(len(list(tmp_path.iterdir())))
        into.mkdir()
        make(into / "mine")
        before = sorted(into.iterdir())
        with pytest.raises(CannotScaffold, match="already exists"):
            scaffold("mine", "Mine", into)
        assert sorted(into.iterdir()) == before


@pytest.mark.parametrize("title", ["", "  ", "two\nlines", "x" * 101, "\x1b[31m"])
def test_what_is_no_title(tmp_path, title):
    with pytest.raises(CannotScaffold, match="invalid title: use one line"):
        scaffold("mine", title, tmp_path)


def test_a_failure_midway_leaves_nothing(tmp_path):
    """Here a disk on which no file of 1000 bytes has room."""
    with largest_file(1000):
        told = command_line.polhode("new-assignment", "mine", "--into", tmp_path)
    assert (
        told.returncode == 2
        and told.stderr.endswith("nothing was created\n")
        and not list(tmp_path.iterdir())
    )


def test_where_the_others_lie_is_where_it_goes(tmp_path, capsys):
    with known(tmp_path):
        assert main(["new-assignment", "mine"]) == 0
        assert (
            tmp_path / "mine" / "assignment.py"
        ).is_file() and "POLHODE_ASSIGNMENTS" not in capsys.readouterr().out
    assert main(["new-assignment", "mine", "--into", str(tmp_path / "other")]) == 0
    assert f"export POLHODE_ASSIGNMENTS={tmp_path / 'other'}\n" in capsys.readouterr().out
