"""The composite action: its own script, run as a runner of GitHub runs it, on submissions of which we know
what becomes of them.
"""

import html
import os
import re
import subprocess

import pytest
import yaml

from tests.support.checkout import ROOT, installed

ACTION = yaml.safe_load((ROOT / "action.yml").read_text())
INPUT = re.compile(r"\$\{\{ inputs\.(\w+) \}\}")


class Runner:
    """A runner's folders and files, with a checkout of submissions and one of the action."""

    def __init__(self, folder):
        self.work, self.action, self.temp = (folder / name for name in ("work", "action", "temp"))
        for path in (self.work, self.action, self.temp):
            path.mkdir()
        self.output, self.summary_file = folder / "output", folder / "summary"

    def run(self, **inputs):
        """What the step printed, and the action's outputs."""
        [step] = ACTION["runs"]["steps"]
        given = {name: about.get("default") for name, about in ACTION["inputs"].items()} | inputs
        environment = {name: INPUT.sub(lambda m: given[m[1]], value) for name, value in step["env"].items()}
        assert (
            step["shell"] == "bash" and "${{" not in step["run"]
        )  # what somebody chose is no part of the script
        self.output.write_text("")
        self.summary_file.write_text("")
        paths = {"ACTION_PATH": self.action, "OUTPUT": self.output, "STEP_SUMMARY": self.summary_file}
        environment |= {f"GITHUB_{name}": str(path) for name, path in paths.items()} | {
            "RUNNER_TEMP": str(self.temp)
        }
        told = subprocess.run(
            ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", step["run"]],
            cwd=self.work, env=os.environ | environment, capture_output=True, text=True, check=False,
        )  # fmt: skip
        outputs = dict(line.split("=", 1) for line in self.output.read_text().splitlines())
        assert outputs.keys() == ACTION["outputs"].keys()
        return told, outputs

    @property
    def summary(self):
        return html.unescape(self.summary_file.read_text())


@pytest.fixture
def runner(tmp_path, rigid_body):
    made = Runner(tmp_path)
    installed(made.action)
    samples = rigid_body.folder / "samples"
    for name in ("right_terms.py", "wrong_zeros.py"):
        (made.work / name).write_bytes((samples / name).read_bytes())
    (made.work / "unreadable.py").write_bytes(b"\xff\xfe")
    return made


def test_outputs_come_from_the_step():
    for name, about in ACTION["outputs"].items():
        assert about["value"] == f"${{{{ steps.grade.outputs.{name} }}}}"


@pytest.mark.slow
def test_what_is_right_passes(runner):
    told, outputs = runner.run(files="right_terms.py", exercises="2", seed="3")
    assert told.returncode == 0, told.stdout + told.stderr
    assert outputs["status"] == "passed" and "::error" not in told.stdout
    assert "right_terms.py" in runner.summary and "could not" not in runner.summary
    with open(f"{outputs['report']}/polhode.xml") as junit:
        assert 'failures="0"' in junit.read()
    with open(f"{outputs['report']}/right_terms/report.json") as report:
        assert '"seed": 3' in report.read()


@pytest.mark.slow
def test_what_is_wrong_or_no_submission_fails_and_is_annotated(runner):
    told, outputs = runner.run(files="wrong_zeros.py\nunreadable.py\n", exercises="2")
    assert (told.returncode, outputs["status"]) == (1, "failed"), told.stdout + told.stderr
    annotated = re.findall(r"^::error file=([^,:]+)", told.stdout, re.MULTILINE)
    assert set(annotated) == {"wrong_zeros.py", "unreadable.py"}
    assert "wrong_zeros.py" in runner.summary and "could not grade" not in runner.summary + told.stdout


@pytest.mark.parametrize(
    "inputs",
    [{"files": ""}, pytest.param({"files": "right_terms.py", "exercises": "9"}, marks=pytest.mark.slow)],
    ids=str,
)
def test_what_we_cannot_grade_is_told_apart_from_what_is_wrong(runner, inputs):
    told, outputs = runner.run(**inputs)
    assert (told.returncode, outputs["status"]) == (2, "fault")
    assert "::error title=polhode could not grade::" in told.stdout and "::error file=" not in told.stdout
    assert "**polhode could not grade** (exit code 2)" in runner.summary


def test_an_installation_that_fails_is_a_fault_of_ours(runner):
    (runner.action / ".venv/bin").unlink()
    (runner.action / ".venv/runtime").unlink()
    told, outputs = runner.run(files="right_terms.py", python="python-of-nowhere")
    assert (told.returncode, outputs["status"]) == (2, "fault")
    assert "**polhode could not grade**" in runner.summary and "== right_terms.py" not in told.stdout
