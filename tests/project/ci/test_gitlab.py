"""The job for GitLab: its own lines, one after the other in a shell as a runner has it."""

import os
import shlex
import subprocess
from xml.etree import ElementTree

import pytest
import yaml

from service.cli.__main__ import _parse
from tests.support.checkout import ROOT, installed

[(_, JOB)] = yaml.safe_load((ROOT / "docs/ci/gitlab-ci.yml").read_text()).items()
[CLONE, *PREPARE] = JOB["before_script"]


def shell(lines, folder, **more):
    return subprocess.run(
        ["bash", "-eo", "pipefail", "-c", "\n".join(lines)],
        cwd=folder, env=os.environ | JOB["variables"] | more, capture_output=True, text=True, check=False,
    )  # fmt: skip


@pytest.fixture
def project(tmp_path):
    """A project in which the first line has cloned polhode."""
    ours = f"file://{tmp_path}/ours.git"
    subprocess.run(["git", "init", "--quiet", "--bare", tmp_path / "ours.git"], check=True)
    subprocess.run(["git", "-C", ROOT, "push", "--quiet", ours, "HEAD:refs/heads/main"], check=True)
    folder = tmp_path / "project"
    (folder / "submissions").mkdir(parents=True)
    told = shell([CLONE], folder, GRADER=ours)
    assert told.returncode == 0 and (folder / ".polhode/requirements/runtime.lock").is_file(), told.stderr
    installed(folder / ".polhode")
    return folder


def test_what_is_kept_is_what_the_script_writes():
    [line] = JOB["script"]
    program, *arguments = shlex.split(line)
    asked = _parse(arguments)
    assert (
        program == ".polhode/.venv/bin/polhode"
        and asked.command == "grade"
        and asked.files == ["submissions"]
    )
    assert (
        str(asked.junit) == JOB["artifacts"]["reports"]["junit"]
        and [str(asked.out)] == JOB["artifacts"]["paths"]
    )


@pytest.mark.parametrize(
    ("name", "code"), [pytest.param("wrong_zeros.py", 1, marks=pytest.mark.slow), (None, 2)]
)
def test_exit_codes_and_what_is_kept(project, rigid_body, name, code):
    if name:
        (project / "submissions" / name).write_bytes((rigid_body.folder / "samples" / name).read_bytes())
    told = shell([*PREPARE, *JOB["script"]], project)
    assert told.returncode == code, told.stdout + told.stderr
    assert JOB["allow_failure"]["exit_codes"] == 1 and JOB["retry"]["exit_codes"] == 2
    [folder], junit = JOB["artifacts"]["paths"], project / JOB["artifacts"]["reports"]["junit"]
    if code == 2:
        assert "no .py or .ipynb file" in told.stderr and not junit.exists()
        return
    assert (project / folder / "index.html").is_file()
    assert ElementTree.parse(junit).findall(".//failure")
