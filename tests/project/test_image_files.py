"""What the image is built from and what docker-compose.yml starts; ``make image-test`` builds and runs it."""

import fnmatch
import json
import os
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
import yaml

from service.cli.server.demo import free_port
from service.settings import Settings
from tests.image.__main__ import HARDENED, NAMESPACES
from tests.support.fake_server import Scripted, says

ROOT = Path(__file__).parents[2]
DOCKERFILE = re.sub(r"\\\n", "", (ROOT / "Dockerfile").read_text())
LOCKS = ("requirements/runtime.lock", "requirements/installer.lock")
PLANTED = (
    ".env",
    ".venv/bin/python",
    "exercises/next/samples/right.py",
    "exercises/rigid_body/__pycache__/scenes.pyc",
)
NEEDED = (
    "service/pages/templates/account.html",
    "service/grading/figures/measured/reference.json",
    "exercises/rigid_body/notebook.ipynb",
    "exercises/rigid_body/course/ecp/validate.py",
)
PASSWORD = "${POSTGRES_PASSWORD:?set it in .env}"


def in_context(path):
    """Whether .dockerignore lets it in: the last pattern that fits the path or a folder above it decides."""
    patterns = [
        line for line in (ROOT / ".dockerignore").read_text().split("\n") if line and not line.startswith("#")
    ]
    above = [path, *(str(p) for p in Path(path).parents if p.parts)]
    let_in = True
    for pattern in patterns:
        names = [pattern.removeprefix("!")]
        if names[0].startswith("**/"):  # at any depth, the top's too
            names = ["*/" * depth + names[0][3:] for depth in range(path.count("/") + 1)]
        if any(
            one.count("/") == name.count("/") and fnmatch.fnmatchcase(one, name)
            for name in names
            for one in above
        ):
            let_in = pattern.startswith("!")
    return let_in


def holds_solutions(name):
    """A sample of an assignment."""
    return "samples/" in name


@pytest.fixture(scope="module")
def context(tmp_path_factory):
    """A copy of what the build is given."""
    folder = tmp_path_factory.mktemp("context")
    for path in subprocess.run(
        ["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.splitlines():
        if in_context(path):
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / path, folder / path)
    return folder


def test_the_context_holds_neither_samples_nor_tests_nor_what_is_private(context):
    names = {str(path.relative_to(context)) for path in context.rglob("*") if path.is_file()}
    assert not [
        name for name in names if holds_solutions(name) or name.startswith(("tests/", "docs/", "bench/", "."))
    ]
    assert not [name for name in PLANTED if in_context(name)]
    copied = re.findall(r"^COPY (?!--from)(.+) \S+$", DOCKERFILE, re.MULTILINE)
    assert {name.split("/")[0] for name in names} == {name for line in copied for name in line.split()}


def test_the_context_is_enough_to_build_the_wheel(context, tmp_path):
    command = [sys.executable, "-m", "hatchling", "build", "--target", "wheel", "--directory", str(tmp_path)]
    subprocess.run(command, cwd=context, check=True, capture_output=True)
    names = zipfile.ZipFile(next(tmp_path.glob("*.whl"))).namelist()
    assert set(NEEDED) <= set(names)
    assert not [name for name in names if holds_solutions(name)]


def test_everything_is_installed_by_hashes_and_nothing_names_a_registry():
    installed = re.findall(r"-r (\S+)", DOCKERFILE)
    assert sorted(installed) == sorted(LOCKS)
    assert DOCKERFILE.count("--require-hashes") == len(installed) and "--no-deps" in DOCKERFILE
    for lock in LOCKS:
        pinned = re.split(r"\n(?=\S)", (ROOT / lock).read_text().strip())
        assert all(
            re.match(r"[\w.-]+==\S+", one) and "--hash=sha256:" in one
            for one in pinned
            if not one.startswith("#")
        ), lock
    for name in (*LOCKS, "Dockerfile", "docker-compose.yml", ".dockerignore"):
        assert not re.search(
            r"(https?|file)://", (ROOT / name).read_text().replace("http://localhost", "")
        ), name


def test_both_stages_are_of_the_base_asked_for_and_the_last_is_nobody():
    assert re.findall(r"^FROM (\S+)", DOCKERFILE, re.MULTILINE) == ["${BASE}", "${BASE}"]
    assert int(re.findall(r"^USER (\S+)$", DOCKERFILE, re.MULTILINE)[-1]) > 0
    assert DOCKERFILE.rstrip().endswith('CMD ["polhode", "serve"]')


def healthcheck(port):
    """The exit code of the image's HEALTHCHECK for a server at that port."""
    command = json.loads(re.search(r"^HEALTHCHECK .* CMD (\[.*\])$", DOCKERFILE, re.MULTILINE)[1])
    environment = os.environ | {"POLHODE_PORT": str(port)}
    return subprocess.run(
        [sys.executable, *command[1:]], env=environment, capture_output=True, check=False, timeout=30
    ).returncode


@pytest.mark.parametrize(("status", "code"), [(200, 0), (503, 1)])
def test_the_healthcheck_asks_whether_a_server_is_ready(status, code):
    server = Scripted()
    server.script.append(says(status))
    try:
        assert healthcheck(server.port) == code
    finally:
        server.stop()
    assert [(seen.method, seen.path) for seen in server.seen] == [("GET", "/readyz")]


def test_the_healthcheck_tells_that_there_is_no_server():
    assert healthcheck(free_port()) == 1


@pytest.mark.slow
def test_the_healthcheck_tells_a_server_that_grades(server):
    assert healthcheck(server.port) == 0


def test_compose_starts_a_server_and_two_workers_on_one_database_with_no_password_in_it():
    text = (ROOT / "docker-compose.yml").read_text()
    services = yaml.safe_load(text)["services"]
    server, worker, database = (services[name] for name in ("server", "worker", "db"))
    assert worker["deploy"]["replicas"] == 2 and worker["command"] == "polhode worker"
    assert server["environment"]["POLHODE_WORKERS"] == 0 and "command" not in server
    for one in (server, worker):
        assert one["environment"]["POLHODE_DATABASE_URL"] == "postgresql://polhode@db/polhode"
        assert one["environment"]["PGPASSWORD"] == database["environment"]["POSTGRES_PASSWORD"] == PASSWORD
        assert one["restart"] == "unless-stopped" and one["init"] and one["read_only"]
    settings = {f"POLHODE_{name.upper()}" for name in Settings.model_fields}
    named = {
        name
        for service in services.values()
        for name in service["environment"]
        if name.startswith("POLHODE_")
    }
    assert named <= settings
    told = (ROOT / "docs/docker.md").read_text()
    for variable in re.findall(r"\$\{(\w+)", text):
        assert variable in told, variable
    assert ".env" in (ROOT / ".gitignore").read_text().split()


def test_the_flags_that_are_tried_are_those_that_are_documented():
    told = re.sub(r"\\\n\s+", "", (ROOT / "docs/docker.md").read_text())
    assert " ".join(HARDENED) in told
    assert " ".join(NAMESPACES) in told


def test_chart_without_numba_says_what_to_install_as_in_the_image():
    assert not any(line.startswith("numba==") for line in (ROOT / LOCKS[0]).read_text().splitlines())
    program = (
        "import sys; sys.modules['numba'] = None; from service.cli.__main__ import main\n"
        "sys.exit(main(['chart']))"
    )
    told = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert told.returncode == 2
    assert told.stderr == (
        "polhode: the reference methods need numba: install polhode's wheel with its extra charts,"
        " or in a clone run make .venv/tests\n"
    )
