"""polhode new-assignment: what it makes works at once, everywhere, and it makes all or nothing."""

import ast
import io
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import urllib.request
import zipfile
from pathlib import Path

import nbformat
import pytest

from exercises import wheel
from service.cli.__main__ import _parse, main
from service.cli.scaffolding import TEMPLATE, CannotScaffold, scaffold
from tests.project.test_docs import documented_codes
from tests.support import command_line
from tests.support.asgi import visit
from tests.support.assignments import change, copied, known
from tests.support.http_client import Browser
from tests.support.limits import largest_file

ROOT = Path(__file__).parents[3]
TITLE = 'The "driven" pendulum: it\'s \\ {{SERVER}} <i>ω</i> \\u0041 $x_1$'


@pytest.fixture
def course(tmp_path):
    """A folder with an assignment made by the command, which this process knows; ruff takes it for the repository's."""
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    with known(tmp_path / "exercises"):
        made = command_line.polhode("new-assignment", "driven-pendulum", "--title", TITLE)
    assert made.returncode == 0, made.stderr
    folder = tmp_path / "exercises" / "driven_pendulum"
    assert made.stdout == f"created {folder}\nnext: polhode verify {folder}\n"
    with known(tmp_path / "exercises"):
        yield tmp_path / "exercises"


@pytest.mark.slow
def test_it_is_verified_listed_and_graded(course, polhode):
    told = polhode("verify", "driven-pendulum", "--jobs", "1", "--only", "right_*", "--only", "wrong_*")
    assert told.returncode == 0 and told.stdout.endswith("driven-pendulum: 13 of 13 samples as expected, 3 checks\n"), told
    assert f"driven-pendulum  {TITLE}  (version 1)\n  1  The equation of motion: oscillator\n" in polhode("assignments").stdout
    samples = course / "driven_pendulum" / "samples"
    right, wrong = (polhode("grade", samples / f"{name}.py") for name in ("right_terms", "wrong_zeros"))
    assert (right.returncode, wrong.returncode) == (0, 1)
    assert "3 of 3 points" in right.stdout and "likely returns-zero" in wrong.stdout


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
    for name in ("exercises", "reference", "service", "tests", "docs"):
        shutil.copytree(ROOT / name, tree / name, ignore=shutil.ignore_patterns("__pycache__", "attacks"))
    for name in ("pyproject.toml", "README.md", "CHANGELOG.md", "Makefile", "Dockerfile", "action.yml", *ROOT.glob("*.lock")):
        shutil.copy(ROOT / name, tree)
    made = inside(tree, "-m", "service.cli", "new-assignment", "driven-pendulum", "--title", TITLE)
    assert made.returncode == 0, made.stderr
    assert made.stdout == f"created {tree}/exercises/driven_pendulum\nnext: polhode verify {tree}/exercises/driven_pendulum\n"
    return tree


def inside(tree, *arguments):
    environment = os.environ | {"PYTHONPATH": f"{tree}{os.pathsep}{tree / 'exercises' / 'kit'}"}
    return subprocess.run(
        [sys.executable, *map(str, arguments)], cwd=tree, env=environment, capture_output=True, text=True, check=False
    )


@pytest.mark.slow
def test_in_the_repository_it_is_verified_listed_and_graded(tree):
    samples = tree / "exercises" / "driven_pendulum" / "samples"
    told = inside(tree, "-m", "service.cli", "verify", "driven-pendulum")
    assert told.returncode == 0 and told.stdout.endswith("driven-pendulum: 14 of 14 samples as expected, 3 checks\n"), told
    listed = inside(tree, "-m", "service.cli", "assignments")
    assert f"driven-pendulum  {TITLE}  (version 1)\n  1  The equation of motion: oscillator\n" in listed.stdout
    right, wrong = (inside(tree, "-m", "service.cli", "grade", samples / f"{name}.py") for name in ("right_terms", "wrong_zeros"))
    assert (right.returncode, wrong.returncode) == (0, 1)
    assert "3 of 3 points" in right.stdout and "likely returns-zero" in wrong.stdout


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
    change(
        tree / "exercises" / "driven_pendulum" / "truth.py",
        "import numpy as np",
        "import numpy as np\n\nimport exercises.rigid_body.scenes",
    )
    broken = inside(tree, "-c", contracts)
    assert broken.returncode == 1 and "exercises.driven_pendulum is not allowed to import exercises.rigid_body" in broken.stdout
    change(tree / "exercises" / "driven_pendulum" / "truth.py", "\n\nimport exercises.rigid_body.scenes", "")
    files = ("tests/exercises/test_assignment.py", "tests/exercises/rigid_body/test_notebook.py", "tests/project/test_docs.py")
    tested = inside(tree, "-m", "pytest", "-p", "no:cacheprovider", *files)
    assert tested.returncode == 0, tested.stdout


KERNEL = """
import json, sys
sys.path.insert(0, "kit")
import ecp
names = {"ecp": ecp}
exec(open(sys.argv[1]).read(), names)
report = eval('ecp.check("1", assignment="driven-pendulum")', names)
assert "exercises" not in sys.modules
print(repr(report))
"""


@pytest.fixture
def kits_home(course):
    """The folder beside which a kit lies that was made while the assignment is known."""
    with zipfile.ZipFile(io.BytesIO(wheel.wheel("driven-pendulum"))) as archive:
        archive.extractall(course.parent / "kit")
    return course.parent


def test_its_public_side_is_in_the_kit_and_gives_the_servers_lines(course, kits_home, polhode):
    home = kits_home / "kit" / "ecp" / "assignments" / "driven_pendulum"
    assert {p.name for p in home.iterdir()} == {
        "__init__.py",
        "figures.py",
        "made.json",
        "parameters.py",
        "plays.py",
        "public.json",
        "truth.npz",
    }
    file = course / "driven_pendulum" / "samples" / "wrong_half_damping.py"
    command = [sys.executable, "-P", "-c", KERNEL, str(file)]
    here = subprocess.run(command, cwd=kits_home, capture_output=True, text=True, check=False, env=os.environ | {"PYTHONPATH": ""})
    assert here.returncode == 0, here.stderr
    served = polhode("grade", file).stdout.splitlines()
    lines = [line for line in here.stdout.splitlines() if line[:1] in "✓✗"]
    assert [line[0] for line in lines] == ["✓", "✗"] and set(lines) <= set(served)


@pytest.fixture
def course_with_a_broken_one(tmp_path):
    scaffold("driven-pendulum", TITLE, tmp_path / "course")
    (copied(tmp_path / "course", "broken_one") / "plays.py").unlink()
    return tmp_path / "course"


def test_it_has_pages_and_a_broken_one_costs_only_itself(course_with_a_broken_one, database_url):
    addresses = ("/v1/assignments", "/v1/assignments/driven-pendulum", "/readyz", "/", "/assignments/driven-pendulum")
    refused = ("/v1/assignments/broken-one", "/assignments/broken-one", "/v1/assignments/broken-one/notebook.ipynb")
    with known(course_with_a_broken_one):
        everything, one, ready, *pages, api, page, notebook = visit(database_url, *addresses, *refused)
    slugs = {assignment["slug"] for assignment in everything.json()}
    assert slugs >= {"rigid-body", "driven-pendulum"} and "broken-one" not in slugs
    checks = ["1-energy", "1-motion", "1-rates"]
    assert one.json()["title"] == TITLE and [c["id"] for c in one.json()["exercises"][0]["checks"]] == checks
    assert ready.json()["checks"]["assignments"] == "broken: broken-one"
    assert all(p.status_code == 200 and "<i>ω" not in p.text and "&lt;i&gt;ω" in p.text for p in pages)
    assert {p.status_code for p in (api, page, notebook)} == {503} and api.json()["type"].endswith(":assignment-broken")


@pytest.mark.slow
def test_a_server_serves_it_and_a_broken_one_costs_only_itself(tmp_path, course_with_a_broken_one, new_server, database_url):
    course = str(course_with_a_broken_one)
    server = new_server(tmp_path / "data", POLHODE_DATABASE_URL=database_url, POLHODE_WORKERS="1", POLHODE_ASSIGNMENTS=course)
    browser = Browser(server)

    def told(path):
        return json.loads(browser.open(path)[1])

    document = told("/v1/assignments/driven-pendulum")
    assert document["title"] == TITLE and [c["id"] for c in document["exercises"][0]["checks"]] == [
        "1-energy",
        "1-motion",
        "1-rates",
    ]
    slugs = {a["slug"] for a in told("/v1/assignments")}
    assert slugs >= {"rigid-body", "driven-pendulum"} and "broken-one" not in slugs
    assert told("/readyz")["checks"]["assignments"] == "broken: broken-one"
    notebook = told(document["notebook"])
    assert 'assignment="driven-pendulum")' in "".join(notebook["cells"][3]["source"])

    sent = submit(server, "driven-pendulum", (TEMPLATE / "samples" / "wrong_half_damping.py").read_text())
    assert sent["report"]["score"] == 1
    for page in (f"/submissions/{sent['id']}", "/", "/assignments/driven-pendulum", "/assignments/driven-pendulum/class"):
        status, text = browser.open(page)
        assert status == 200 and "<i>ω" not in text and "Traceback" not in text
    assert "sweep.svg" not in browser.open(f"/submissions/{sent['id']}")[1]  # it has none
    assert browser.open(f"/v1/submissions/{sent['id']}/figures/motion.svg")[0] == 200

    for path in ("/v1/assignments/broken-one", "/assignments/broken-one", "/v1/assignments/broken-one/notebook.ipynb"):
        assert browser.open(path)[0] == 503
    with pytest.raises(urllib.error.HTTPError) as caught:
        submit(server, "broken-one", "def oscillator(): ...")
    assert caught.value.code == 503 and json.load(caught.value)["type"].endswith(":assignment-broken")
    assert "assignment broken-one: plays.py is missing" in server.log.read_text()


def submit(server, slug, source):
    headers = {"Content-Type": "application/json", "Prefer": "wait=30"}
    request = urllib.request.Request(
        f"{server.url}/v1/assignments/{slug}/submissions", json.dumps({"source": source}).encode(), headers
    )
    with urllib.request.urlopen(request, timeout=60) as answer:
        return json.load(answer)


def test_the_templates_codes_are_documented_and_it_imports_only_itself():
    with known(TEMPLATE.parent) as found:
        assert set(found.valid["damped-oscillator"].codes) <= documented_codes()
    for file in TEMPLATE.glob("*.py"):
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.ImportFrom) and not node.level:
                assert node.module.split(".")[0] in (
                    "ecp",
                    "numpy",
                    "scipy",
                    "pathlib",
                    "collections",
                    "dataclasses",
                    "typing",
                ) or (node.module == "exercises.assignment"), (file, node.module)


def test_the_templates_notebook_asks_for_just_what_is_graded():
    notebook = json.loads((TEMPLATE / "notebook.ipynb").read_text())
    assert (TEMPLATE / "notebook.ipynb").read_text() == json.dumps(notebook, indent=1, ensure_ascii=False) + "\n"
    cells = {cell["id"]: "".join(cell["source"]) for cell in notebook["cells"]}
    assert all(cell.get("outputs", []) == [] for cell in notebook["cells"])
    (function,) = ast.parse(cells["ex1-oscillator"]).body
    assert ast.get_docstring(function) and ast.unparse(function.body[1]) == "..."
    assert f"ecp.submit({function.name})" == cells["submit"] and cells["ex1-check"] == 'ecp.check("1")'
    with known(TEMPLATE) as found:
        assert found.valid["damped-oscillator"].functions() == {function.name}
    setup = (TEMPLATE / "setup.py").read_text().split('"""\n\n', 1)[1].split("\n\n__all__")[0]
    assert cells["setup"].startswith(setup)
    right = (TEMPLATE / "samples" / "right_terms.py").read_text().splitlines()[-1].strip()
    assert right not in "".join(cells.values())


def test_the_guide_for_authors_names_every_file_and_its_commands_are_there():
    guide = (ROOT / "docs" / "authors.md").read_text()
    for path in TEMPLATE.iterdir():
        assert path.name == "__pycache__" or f"| `{path.name}{'/' * path.is_dir()}` |" in guide, path.name
    blocks = re.findall(r"```sh\n(.*?)```", guide, re.DOTALL)
    commands = [shlex.split(line, comments=True) for block in blocks for line in block.splitlines() if line.startswith("polhode")]
    assert len(commands) >= 8
    for command in commands:
        assert _parse(command[1:]).run


@pytest.mark.parametrize("title", [TITLE, "'", '"', "\\", "\\N{BULLET}", "{0} %s {{KIT_URL}}", "# ``` </script> é 漢 𝄞", "x" * 100])
def test_any_title_stands_as_it_is(tmp_path, title):
    folder = scaffold("driven-pendulum", title, tmp_path)
    with known(folder) as found:
        assert found.valid["driven-pendulum"].title == title
    notebook = json.loads((folder / "notebook.ipynb").read_text())
    nbformat.validate(nbformat.from_dict(notebook))
    text = (folder / "notebook.ipynb").read_text()
    assert text.count("{{SERVER}}") == 1 and text.count("{{KIT_URL}}") == 1
    written = [p for p in folder.rglob("*") if p.is_file() and p.suffix != ".pyc"]
    left = [p for p in written if "damped-oscillator" in p.read_text()]
    assert not left


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
    "wheel",
    "kit",
    "a\n",
]


@pytest.mark.parametrize("slug", SLUGS)
def test_what_is_no_slug_or_is_taken_makes_nothing(tmp_path, capsys, slug):
    assert main(["new-assignment", "--into", str(tmp_path), "--", slug]) == 2
    assert capsys.readouterr().err.startswith("polhode: ") and not list(tmp_path.iterdir())


def test_nothing_is_overwritten(tmp_path):
    for make in (lambda path: path.mkdir(), lambda path: path.symlink_to("nowhere"), lambda path: path.with_suffix(".py").touch()):
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
    """Here a disk on which no file of 3000 bytes has room."""
    with largest_file(3000):
        told = command_line.polhode("new-assignment", "mine", "--into", tmp_path)
    assert told.returncode == 2 and told.stderr.endswith("nothing was created\n") and not list(tmp_path.iterdir())


def test_where_the_others_lie_is_where_it_goes(tmp_path, capsys):
    with known(tmp_path):
        assert main(["new-assignment", "mine"]) == 0
        assert (tmp_path / "mine" / "plays.py").is_file() and "POLHODE_ASSIGNMENTS" not in capsys.readouterr().out
    assert main(["new-assignment", "mine", "--into", str(tmp_path / "other")]) == 0
    assert f"export POLHODE_ASSIGNMENTS={tmp_path / 'other'}\n" in capsys.readouterr().out
