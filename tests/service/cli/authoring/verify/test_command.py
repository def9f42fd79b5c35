"""polhode verify: samples against what is expected of them, on copies of the template of a new assignment."""

import re
import tomllib
from dataclasses import replace
from pathlib import Path

import pytest

from service.cli.__main__ import main
from service.cli.authoring.verify import tally, written_samples
from service.grading.graded_file import GradedFile
from tests.support.assignments import change, copied, known
from tests.support.reports import SLOW, outcome, report

RIGHT = "def oscillator(t, y, omega, gamma):\n    return [y[1], -omega**2 * y[0] - 2 * gamma * y[1]]\n"
HALF = RIGHT.replace("2 * gamma", "gamma")


@pytest.fixture
def folder(tmp_path, warm_guest):
    return copied(tmp_path)


def verify(folder, *options):
    with known():
        return main(["verify", "--jobs", "1", str(folder), *options])


def entries(folder):
    return tomllib.loads((folder / "samples" / "expected.toml").read_text())


@pytest.mark.slow
def test_the_templates_expectations_are_what_comes_and_show_every_check(folder, capsys):
    whole = (folder / "samples" / "expected.toml").read_text()
    head, _, written = whole.partition('["right_matrix.py"]')  # the head has the sample that never ends
    (folder / "samples" / "expected.toml").write_text(head)
    assert verify(folder, "--write") == 0
    assert (folder / "samples" / "expected.toml").read_text() == whole and written
    told = capsys.readouterr()
    names = [f"✓  {name}{'' if name in head else '   (entry written)'}" for name in tomllib.loads(whole)]
    assert told.out.splitlines()[-len(names) - 1 :] == [
        *names,
        "damped-oscillator: 14 of 14 samples as expected, 3 checks",
    ]
    assert told.err == ""


def test_every_difference_is_told_with_its_line_and_cause(folder, capsys):
    expected = folder / "samples" / "expected.toml"
    change(
        expected,
        '["right_terms.py"]\nexercises = ["1"]',
        '["right_terms.py"]\nexercises = ["1"]\nfail = ["1-value"]\ncodes = ["units"]',
    )
    change(
        expected,
        'fail = ["1-value", "1-motion", "1-new-value"]\ncodes = ["constant-factor"]',
        'left_out = ["1-new-value"]\nfail = ["1-value"]',
    )
    assert (
        verify(folder / "samples", "--only", "right_*", "--only", "wrong_half_damping.py", "--seed", "5") == 1
    )
    told = capsys.readouterr().out
    assert re.sub(r"[\d.]+e-17", "6e-17", told) == GOLDEN, told  # the digits of rounding are the processor's


GOLDEN = """\
✓  right_all.py
damped-oscillator: 1 of 1 samples as expected on 4 seeds, 3 checks
✓  right_matrix.py
✗  right_terms.py
     1-value: expected ✗, got ✓
       ✓  oscillator is right   [max|Δ|/scale = 6e-17 (limit 1e-12)]
     missing diagnosis codes: units
✗  wrong_half_damping.py
     1-motion: expected ✓, got ✗
       ✗  oscillator drives the right motion   [max|Δ|/scale = 0.407822 (limit 1e-06)]
            worst at t = 4.2, y = [-1.8657, 0.9186], omega = 0.509585, gamma = 0.396861
            likely constant-factor: the damping is half as large: its term is −2γv
     1-new-value: expected no result, got ✗
       ✗  oscillator is right (new inputs)   [max|Δ|/scale = 0.149673 (limit 1e-12)]
            worst at t = 19.0322, y = [ 1.4375, -1.6679], omega = 3.83317, gamma = 2.27435: got -17.33
            likely constant-factor: the damping is half as large: its term is −2γv
     unexpected diagnosis code: constant-factor (the damping is half as large: its term is −2γv)
damped-oscillator: 1 of 3 samples as expected, 3 checks
"""


def test_files_without_entry_and_entries_without_file(folder, capsys):
    (folder / "samples" / "wrong_new.py").write_text(HALF)
    (folder / "samples" / "right_matrix.py").unlink()
    (folder / "samples" / "wrong_text.py").write_bytes(b"\xff")
    assert verify(folder, "--only", "wrong_[nt]e[wx]*") == 1
    told = capsys.readouterr().out
    assert (
        '--write would add\n     ["wrong_new.py"]\n     exercises = ["1"]\n'
        '     fail = ["1-value", "1-motion", "1-new-value"]' in told
    )
    assert (
        "wrong_text.py\n     cannot be graded: wrong_text.py is not a text file (UTF-8): save it as UTF-8"
        in told
    )
    assert told.endswith("right_matrix.py: listed in expected.toml, but the file does not exist\n")


@pytest.mark.slow
def test_write_adds_what_is_missing_and_changes_nothing_else(folder, capsys):
    """A name that does not tell its report gets no entry: a right_ that is wrong must not become what is
    expected.
    """
    expected = folder / "samples" / "expected.toml"
    before = (
        '# mine\n["wrong_half_damping.py"]\ndemo = true\nexercises = ["1"]  # kept\n'
        'fail = ["1-value", "1-motion", "1-new-value"]\n'
    )
    before += 'codes = ["constant-factor"]'
    expected.write_text(before)
    (folder / "samples" / 'wrong_"ω".py').write_text(HALF)
    (folder / "samples" / "right_not.py").write_text(HALF)
    (folder / "samples" / "wrong_not.py").write_text(RIGHT)
    options = [
        "--write",
        "--only",
        "wrong_half_damping.py",
        "--only",
        "*ω*",
        "--only",
        "*_not.py",
        "--only",
        "right_terms.py",
    ]
    assert verify(folder, *options) == 1
    told = capsys.readouterr().out
    assert expected.read_text().startswith(before + "\n")
    assert list(entries(folder)) == ["wrong_half_damping.py", "right_terms.py", 'wrong_"ω".py']
    assert entries(folder)['wrong_"ω".py'] == {
        "exercises": ["1"],
        "fail": ["1-value", "1-motion", "1-new-value"],
        "codes": ["constant-factor"],
    }
    assert told.count("(entry written)") == 2 and told.count("and none was added") == 2
    assert verify(folder, *options[1:5], "--only", "right_terms.py") == 0


def test_a_time_out_is_not_written_because_a_busy_machine_can_cause_it(rigid_body):
    wrong = report([outcome("1-box", "fail"), outcome("1-notebook", "unmeasured", cause=SLOW.sentence)])
    timed_out = replace(wrong, scene_ends=[SLOW])
    graded, late = (GradedFile(file=Path("wrong_x.py"), report=one) for one in (wrong, timed_out))
    assert (
        written_samples.new_entry(rigid_body, graded) and written_samples.new_entry(rigid_body, late) is None
    )
    (sentence,) = written_samples.missing_entry(rigid_body, late)
    assert "none was added: motion did not finish in time, and a busy machine can cause that" in sentence


def test_what_no_sample_shows_is_a_warning(folder, capsys):
    for name in entries(folder):
        if name != "wrong_no_return.py":
            (folder / "samples" / name).unlink()
    expected = folder / "samples" / "expected.toml"
    expected.write_text("\n\n".join(e for e in expected.read_text().split("\n\n") if "no_return" in e))
    assert verify(folder) == 0
    assert capsys.readouterr().out.splitlines()[-3:] == [
        "damped-oscillator: 1 of 1 samples as expected, 3 checks",
        "warning: no sample fails 1-value, 1-motion, 1-new-value",
        "warning: no sample is all ✓",
    ]


def test_a_right_sample_that_needs_much_time_is_a_warning(folder, capsys, monkeypatch):
    for name in entries(folder):
        if name != "right_terms.py":
            (folder / "samples" / name).unlink()
    expected = folder / "samples" / "expected.toml"
    expected.write_text("\n\n".join(e for e in expected.read_text().split("\n\n") if "right_terms" in e))
    monkeypatch.setattr(tally, "CPU_FACTOR", 1e4)
    assert verify(folder) == 0
    last = capsys.readouterr().out.splitlines()[-1]
    assert last.startswith("warning: grading a right sample used 0.") and "declare cpu_s=" in last


def test_every_error_of_the_expectations_is_told_and_nothing_is_graded(folder, capsys):
    expected = folder / "samples" / "expected.toml"
    change(
        expected,
        'unmeasured = ["1-value", "1-motion", "1-new-value"]\ncodes = ["timeout"]',
        'unmesured = ["1-value"]',
    )
    change(expected, '["right_matrix.py"]\nexercises = ["1"]', '["right_matrix.py"]\nask = ["9"]')
    change(
        expected,
        'fail = ["1-value", "1-motion", "1-new-value"]\ncodes = ["returns-zero"]',
        'fail = ["1-motoin", "1-value"]\nleft_out = ["1-value"]',
    )
    change(expected, 'codes = ["wrong-power"]', 'codes = "wrong-power"')
    assert verify(folder) == 2
    told = capsys.readouterr()
    assert told.out == ""
    for part in (
        "hostile_endless.py: unknown key unmesured",
        "right_matrix.py: exercises (the numbers of the graded exercises) is missing",
        "right_matrix.py: there is no exercise 9",
        "wrong_zeros.py: its exercises have no check 1-motoin",
        "wrong_zeros.py: the check 1-value is listed more than once",
        "wrong_omega_not_squared.py: codes is not a list of strings",
    ):
        assert part in told.err
    expected.write_text("[")
    assert verify(folder) == 2 and "samples/expected.toml: " in capsys.readouterr().err


def test_what_cannot_be_graded_is_no_difference(folder, capsys):
    """A setup cell that fails is the author's: not one sample gets a verdict, and none an entry."""
    change(folder / "notebook.ipynb", "import numpy as np", "import numpy as np; __import__('reference')")
    (folder / "samples" / "expected.toml").unlink()
    assert verify(folder, "--only", "right_terms.py", "--write") == 2
    told = capsys.readouterr()
    assert "?  right_terms.py   not graded (system fault): " in told.out
    assert "0 of 1 samples as expected, 0 checks; 1 not graded" in told.out
    assert not (folder / "samples" / "expected.toml").exists()
    with known(folder):
        assert main(["grade", str(folder / "samples" / "right_terms.py")]) == 2
    assert "not graded: " in capsys.readouterr().err


def test_a_truth_that_fails_is_told_with_its_line_and_costs_no_other(folder, capsys):
    change(folder / "assignment.py", "np.sqrt(omega**2 - gamma**2)", "np.sqroot(omega**2 - gamma**2)")
    second = copied(folder.parent, "second")
    assert verify(folder, str(second), "--only", "right_terms.py") == 2
    told = capsys.readouterr()
    place = "polhode: assignment damped-oscillator: assignment.py line 37: AttributeError: module 'numpy'"
    assert place in told.err
    assert "second: 1 of 1 samples as expected" in told.out


@pytest.mark.slow
@pytest.mark.parametrize("jobs", ["1", "2"])
def test_an_assignment_that_leaves_by_sys_exit_gives_no_verdict(folder, capsys, jobs):
    """Its exit code would be an answer of ours."""
    change(
        folder / "assignment.py",
        "        w, (x, v)",
        "        import sys\n\n        sys.exit(0)\n        w, (x, v)",
    )
    files = [str(folder / "samples" / name) for name in ("right_terms.py", "wrong_zeros.py")]
    with known(folder):
        assert main(["grade", "--jobs", jobs, *files]) == 2
    told = capsys.readouterr()
    place = "wrong_zeros.py: not graded: assignment damped-oscillator has an error: assignment.py line"
    assert place in told.err and "SystemExit: 0" in told.err
    assert "2 files: 2 not graded" in told.out


def test_an_export_of_a_broken_assignment_tells_what_is_wrong_with_it(folder, capsys, tmp_path):
    (folder / "assignment.py").write_text("(")
    with known(folder):
        assert (
            main(
                [
                    "export",
                    "gradescope",
                    "--assignment",
                    "damped_oscillator",
                    "--out",
                    str(tmp_path / "x.zip"),
                ]
            )
            == 2
        )
    assert (
        "assignment.py line 1: '(' was never closed" in capsys.readouterr().err
        and not (tmp_path / "x.zip").exists()
    )


@pytest.mark.slow
def test_nothing_to_grade(folder, capsys):
    for path in (folder, folder / "samples", folder.parent):
        assert verify(path, "--only", "nothing*") == 2
        assert "damped-oscillator: no sample to grade" in capsys.readouterr().err
    (folder / "assignment.py").unlink()
    assert verify(folder) == 2 and "damped-oscillator: assignment.py is missing" in capsys.readouterr().err
    assert verify(folder.parent) == 2 and f"no assignment found in {folder.parent}" in capsys.readouterr().err
    assert main(["verify", "knitting"]) == 2 and "there is no assignment knitting" in capsys.readouterr().err
