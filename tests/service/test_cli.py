import json
import subprocess
import sys

import pytest


def polhode(*arguments, **environment):
    import os

    return subprocess.run(
        [sys.executable, "-m", "service.cli", *map(str, arguments)],
        capture_output=True,
        text=True,
        env=os.environ | environment,
        check=False,
    )


@pytest.fixture
def folder(rigid_body):
    return rigid_body.folder / "specimens"


def test_assignments():
    told = polhode("assignments")
    assert told.returncode == 0 and told.stdout.startswith("rigid-body  2.6 Rigid-Body Rotation")


def test_grade_prints_lines_and_exits_0_when_all_pass(folder, tmp_path):
    told = polhode("grade", folder / "right_all.py", "--exercise", "2", "--exercise", "6", "--out", tmp_path)
    assert told.returncode == 0, told.stderr
    assert "✓  rotational energy conserved (torque-free)   [" in told.stdout and "13 of 13 checks ✓" in told.stdout
    written = {p.name for p in (tmp_path / "right_all").iterdir()}
    assert written == {"report.txt", "report.json", "omega.svg", "omega-residual.svg", "cone.svg", "precession.png"}


def test_grade_exits_1_when_some_fail_and_json_is_all_of_stdout(folder):
    told = polhode("grade", folder / "right_terms.py", folder / "wrong_zeros.py", "--exercise", "2", "--json", "--seed", "3")
    document = json.loads(told.stdout)
    assert told.returncode == 1
    assert [r["report"]["passed"] for r in document["reports"]] == [True, False]
    assert document["reports"][0]["report"]["provenance"]["seed"] == 3


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        (["nowhere.py"], "nowhere.py"),
        (["right_terms.py", "--exercise", "9"], "no exercise 9"),
    ],
)
def test_grade_exits_2_when_it_cannot_grade(folder, arguments, why):
    told = polhode("grade", folder / arguments[0], *arguments[1:])
    assert told.returncode == 2 and why in told.stderr and told.stdout == ""


def test_one_unreadable_submission_does_not_cost_the_others_theirs(folder, tmp_path):
    bad = tmp_path / "bad.py"
    bad.write_bytes(b"\xff\xfe")
    told = polhode("grade", bad, folder / "right_terms.py", "--exercise", "2", "--json")
    reports = json.loads(told.stdout)["reports"]
    assert told.returncode == 1 and "not a text file" in told.stderr
    assert reports[0]["report"] is None and reports[1]["report"]["passed"]


def test_reports_of_files_with_one_name_do_not_overwrite_each_other(folder, tmp_path):
    for student in ("alice", "bob"):
        (tmp_path / student).mkdir()
        (tmp_path / student / "ex.py").write_text((folder / "wrong_zeros.py").read_text())
    files = [tmp_path / s / "ex.py" for s in ("alice", "bob")]
    assert polhode("grade", *files, "--exercise", "2", "--out", tmp_path / "out").returncode == 1
    assert len(list((tmp_path / "out").iterdir())) == 2


def test_grade_needs_neither_web_nor_database(folder):
    script = (
        "import sys\nfor name in ('fastapi', 'sqlalchemy', 'psycopg', 'uvicorn'):\n    sys.modules[name] = None\n"
        f"from service.cli import main\nsys.exit(main(['grade', {str(folder / 'right_terms.py')!r}, '--exercise', '2']))"
    )
    assert subprocess.run([sys.executable, "-c", script], capture_output=True, check=False).returncode == 0
