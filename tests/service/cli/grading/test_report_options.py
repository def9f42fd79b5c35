"""What polhode grade leaves for other systems, read back."""

import argparse
import csv
import json
from pathlib import Path
from xml.etree import ElementTree

import pytest

from service.cli.grading import report_options
from service.grading.graded_file import GradedFile
from service.sandbox.result import SystemFault
from service.sandbox.sandbox import Sandbox
from tests.support.workflow_log import commands

FORGER = """
import numpy as np
print("::error file=forged.py::forged")
print("  ::stop-commands::x")
print("##[error]forged")

def euler_eqs(t, w, I):
    raise ValueError("::warning::forged\\n::error::forged")
"""


@pytest.fixture
def folder(rigid_body, tmp_path, monkeypatch):
    """The current folder, with three submissions."""
    for name in ("right_terms.py", "wrong_zeros.py"):
        (tmp_path / name).write_text((rigid_body.folder / "samples" / name).read_text())
    (tmp_path / "forger.py").write_text(FORGER)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_one_grading_in_every_form_agrees(polhode, folder):
    options = ("--exercise", "2", "--jobs", "1", "--junit", "out/j.xml", "--csv", "out/g.csv", "--json")
    told = polhode("grade", "right_terms.py", "wrong_zeros.py", *options)
    reports = [r["report"] for r in json.loads(told.stdout)["reports"]]
    suites = ElementTree.parse(folder / "out" / "j.xml").getroot().findall("testsuite")
    lines = list(csv.DictReader((folder / "out" / "g.csv").read_text(encoding="utf-8-sig").splitlines()))
    assert told.returncode == 1 and [r["score"] for r in reports] == [5, 2]
    assert [int(s.get("tests")) - int(s.get("failures")) for s in suites] == [5, 2]
    assert [(line["student"], line["points"]) for line in lines] == [
        ("right_terms", "5"),
        ("wrong_zeros", "2"),
    ]
    for report, line in zip(reports, lines, strict=True):
        assert {o["id"]: o["verdict"] for e in report["exercises"] for o in e["outcomes"]} == {
            id: state for id, state in line.items() if id.startswith("2-") and state
        }


@pytest.mark.slow
def test_points_are_out_of_the_exercises_asked_for_also_of_what_is_no_submission(polhode, folder):
    """Else all that was asked would be a seventh of the points, and a grade's most would change with a file
    that cannot be read.
    """
    (folder / "binary.py").write_bytes(b"\0")
    options = ("--exercise", "2", "--jobs", "1", "--csv", "g.csv")
    polhode("grade", "right_terms.py", "binary.py", *options)
    lines = list(csv.DictReader((folder / "g.csv").read_text(encoding="utf-8-sig").splitlines()))
    assert [(line["points"], line["max_points"], float(line["percent"])) for line in lines] == [
        ("5", "5", 100),
        ("0", "5", 0),
    ]
    polhode("grade", "binary.py", "--assignment", "rigid-body", "--exercise", "2", "--gradescope", "r.json")
    (test,) = json.loads((folder / "r.json").read_text())["tests"]
    assert (test["score"], test["max_score"]) == (0, 5)


@pytest.mark.slow
def test_gradescope_has_the_figures_of_the_one_file_and_is_refused_for_two(polhode, folder):
    told = polhode("grade", "wrong_zeros.py", "--exercise", "2", "--gradescope", "r.json")
    document = json.loads((folder / "r.json").read_text())
    assert told.returncode == 1 and document["score"] == 2
    assert document["tests"][-1]["output"].count('<img src="data:image/png;base64,') == 2
    assert {test["visibility"] for test in document["tests"]} == {"visible"}
    asked = ("--exercise", "2", "--gradescope", "r.json", "--hidden", "after_due_date")
    assert polhode("grade", "wrong_zeros.py", *asked).returncode == 1
    later = {t["name"]: t["visibility"] for t in json.loads((folder / "r.json").read_text())["tests"]}
    assert list(later.values()).count("after_due_date") == 2 and later["Figures"] == "visible"
    (folder / "r.json").unlink()
    for ignored in (("--hidden", "visible"), ("--max-score", "10")):
        told = polhode("grade", "right_terms.py", "--exercise", "2", *ignored, "--csv", "g.csv")
        assert (
            told.returncode == 2
            and "give --gradescope FILE too" in told.stderr
            and not (folder / "g.csv").exists()
        )
    told = polhode("grade", ".", "--gradescope", "r.json")
    assert told.returncode == 2 and "--gradescope takes one file, got 3" in told.stderr
    assert not told.stdout and not (folder / "r.json").exists()


def test_classroom50_by_its_runners_variables(polhode, folder, monkeypatch):
    runner = {
        "CLASSROOM": "c",
        "ASSIGNMENT": "a",
        "OWNER": "ann",
        "SUBMISSION_TAG": "submit/2026-03-01T10-00-00Z-abc1234",
    }
    runner |= {"COMMIT_URL": "https://example.org/c", "RELEASE_URL": "https://example.org/r"}
    asked = ("grade", "right_terms.py", "--exercise", "2", "--classroom50", "result.json")
    for name, value in runner.items():
        monkeypatch.setenv(name, value)
    told = polhode(*asked)
    document = json.loads((folder / "result.json").read_text())
    assert (
        told.returncode == 0
        and document["datetime"] == "2026-03-01T10:00:00Z"
        and (document["score"], document["max-score"]) == (5, 5)
    )
    (folder / "result.json").unlink()
    monkeypatch.delenv("CLASSROOM")
    told = polhode(*asked)
    assert (
        told.returncode == 2
        and "CLASSROOM is not set" in told.stderr
        and not (folder / "result.json").exists()
    )


def test_in_github_actions_only_our_own_commands_are_heard(polhode, folder, monkeypatch):
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(folder / "summary.md"))
    told = polhode("grade", ".", "--exercise", "2", "--jobs", "1", "--github")
    heard = commands(told.stdout + told.stderr)
    assert told.returncode == 1 and told.stdout.count("forged") >= 3
    assert {(name, about["file"]) for name, about, _ in heard} == {
        ("error", "forger.py"),
        ("error", "wrong_zeros.py"),
    }
    (forger,) = [about for _, about, _ in heard if about["file"] == "forger.py"]
    assert forger["line"] == "8"  # where it raised
    assert "| <code>right&#95;terms&#46;py</code> | ✓ | 5 of 5 |" in (folder / "summary.md").read_text()


def test_in_github_actions_no_command_of_a_student_is_heard_also_where_nobody_asked_for_ours(
    polhode, folder, monkeypatch
):
    monkeypatch.setenv("GITHUB_ACTIONS", "true")
    told = polhode("grade", "forger.py", "--exercise", "2")
    assert told.stdout.count("::stop-commands::") == 1 and commands(told.stdout + told.stderr) == []


@pytest.mark.parametrize("form", ["csv", "gradescope"])
def test_after_a_fault_nothing_is_written_that_could_be_taken_for_a_grade(rigid_body, tmp_path, form):
    asked = dict.fromkeys(("csv", "gradescope", "classroom50", "junit", "out", "exercise", "max_score"))
    asked |= {"github": False, "hidden": None}
    arguments = argparse.Namespace(**asked | {form: tmp_path / "grades", "junit": tmp_path / "junit.xml"})
    file = Path("x.py")
    report_options.ReportFiles(arguments, [file]).write(
        [GradedFile(file=file, fault="the guest went away")], rigid_body
    )
    assert [p.name for p in tmp_path.iterdir()] == ["junit.xml"]
    (case,) = ElementTree.parse(tmp_path / "junit.xml").getroot().iter("testcase")
    assert "the guest went away" in case.find("error").text


def test_what_an_earlier_run_left_is_no_grade_of_this_one(polhode, folder, monkeypatch):
    (folder / "r.json").write_text('{"score": 5}')
    asked = ("grade", "right_terms.py", "--exercise", "2", "--gradescope", "r.json")
    with monkeypatch.context() as settings:
        settings.setenv("POLHODE_MIN_ISOLATION", "C")
        assert polhode(*asked).returncode == 2 and (folder / "r.json").exists()  # nothing had begun

    def lost(*arguments):
        raise SystemFault("the guest went away")

    monkeypatch.setattr(Sandbox, "play", lost)
    told = polhode(*asked)
    assert told.returncode == 2 and "the guest went away" in told.stderr and not (folder / "r.json").exists()


def test_points_in_gradescope_can_be_scaled(polhode, folder):
    asked = ("--exercise", "2", "--gradescope", "r.json", "--max-score", "10")
    assert polhode("grade", "wrong_zeros.py", *asked).returncode == 1
    document = json.loads((folder / "r.json").read_text())
    assert document["score"] == 4 and sum(test.get("max_score", 0) for test in document["tests"]) == 10
    assert polhode("grade", "wrong_zeros.py", *asked[:-1], "-1").returncode == 2


def test_a_summary_that_cannot_be_written_changes_no_verdict(polhode, folder, monkeypatch):
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", "/dev/full")
    told = polhode("grade", "right_terms.py", "--exercise", "2", "--github")
    assert told.returncode == 0 and "cannot write the job summary" in told.stderr
