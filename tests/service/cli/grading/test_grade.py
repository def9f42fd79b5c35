import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from service.cli.__main__ import main
from tests.support.assignments import change, copied, known

COMMAND = [sys.executable, "-m", "service.cli"]
BUFFERED = {
    name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"
}  # as where nobody set it


@pytest.fixture
def folder(rigid_body):
    return rigid_body.folder / "samples"


def test_assignments(polhode):
    told = polhode("assignments")
    assert told.returncode == 0 and "rigid-body  2.6 Rigid-Body Rotation" in told.stdout


def test_grade_prints_lines_and_exits_0_when_all_pass(polhode, folder, tmp_path):
    told = polhode("grade", folder / "right_all.py", "--exercise", "2", "--exercise", "6", "--out", tmp_path)
    assert told.returncode == 0, told.stderr
    assert (
        "✓  rotational energy conserved (torque-free)   [" in told.stdout and "13 of 13 points" in told.stdout
    )
    written = {p.name for p in (tmp_path / "right_all").iterdir()}
    assert written == {
        "index.html",
        "report.txt",
        "report.json",
        "omega.svg",
        "omega-residual.svg",
        "cone.svg",
        "precession.png",
    }
    assert 'href="right_all/index.html"' in (tmp_path / "index.html").read_text()


def test_grade_exits_1_when_some_fail_and_json_is_all_of_stdout(polhode, folder):
    told = polhode(
        "grade",
        folder / "right_terms.py",
        folder / "wrong_zeros.py",
        "--exercise",
        "2",
        "--jobs",
        "1",
        "--json",
        "--seed",
        "3",
    )
    document = json.loads(told.stdout)
    assert told.returncode == 1
    assert [r["report"]["passed"] for r in document["reports"]] == [True, False]
    assert document["reports"][0]["report"]["provenance"]["seed"] == 3


@pytest.mark.slow
def test_grade_has_the_servers_time_limits(tmp_path):
    (tmp_path / "sleeps.py").write_text("import time\ntime.sleep(1000)\n")
    environment = os.environ | {"POLHODE_GRADING_WALL": "2"}
    done = subprocess.run(
        [*COMMAND, "grade", tmp_path / "sleeps.py", "--assignment", "rigid-body", "--exercise", "2"],
        env=environment,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 1 and "your submission did not finish within 2 s in all" in done.stdout, (
        done.stderr
    )


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        (["nowhere.py"], "nowhere.py"),
        (["right_terms.py", "--exercise", "9"], "no exercise 9"),
        (["right_terms.py", "--assignment", "knitting"], "no assignment knitting; known: "),
        (["right_terms.py", "--jobs", "0"], "expected at least 1"),
        (["right_terms.py", "--seed=-1"], "argument --seed: expected a seed of 0 or more"),
        (["right_terms.py", "--out", "/dev/null/x"], "/dev/null/x"),
    ],
)
def test_grade_exits_2_when_it_cannot_grade(polhode, folder, arguments, why):
    told = polhode("grade", folder / arguments[0], *arguments[1:])
    assert told.returncode == 2 and why in told.stderr and told.stdout == ""


def test_one_unreadable_submission_does_not_cost_the_others_theirs(polhode, folder, tmp_path):
    bad = tmp_path / "bad.py"
    bad.write_bytes(b"\xff\xfe")
    told = polhode("grade", bad, folder / "right_terms.py", "--exercise", "2", "--jobs", "1", "--json")
    reports = json.loads(told.stdout)["reports"]
    assert told.returncode == 1 and "not a text file" in told.stderr
    assert reports[0]["report"] is None and reports[1]["report"]["passed"]


def test_reports_of_files_with_one_name_do_not_overwrite_each_other(polhode, folder, tmp_path):
    for student in ("alice", "bob"):
        (tmp_path / student).mkdir()
        (tmp_path / student / "ex.py").write_text((folder / "wrong_zeros.py").read_text())
    files = [tmp_path / s / "ex.py" for s in ("alice", "bob")]
    assert (
        polhode("grade", *files, "--exercise", "2", "--jobs", "1", "--out", tmp_path / "out").returncode == 1
    )
    assert len(list((tmp_path / "out").glob("*/report.json"))) == 2


@pytest.mark.slow  # an import contract forbids it
def test_grade_imports_neither_web_nor_database_nor_another_assignment(folder, tmp_path):
    file = shutil.copy(folder / "right_terms.py", tmp_path)
    absent = {"fastapi", "sqlalchemy", "psycopg", "uvicorn", "numba", "sympy"}
    script = (
        f"import sys\nfrom service.cli.__main__ import main\nmain(['grade', {file!r}, '--exercise', '2'])\n"
        f"print({absent} & sys.modules.keys(), file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, check=False, text=True)
    assert done.stderr == "set()\n" and "✗" not in done.stdout and "✓" in done.stdout


@pytest.mark.slow
def test_many_files_are_graded_in_several_processes_and_told_in_order(polhode, folder, tmp_path):
    for number in range(5):
        (tmp_path / f"s{number}.py").write_text(
            (folder / ("wrong_zeros.py" if number == 3 else "right_terms.py")).read_text()
        )
    told = polhode("grade", tmp_path, "--exercise", "2", "--jobs", "2", "--seed", "7")
    assert [line for line in told.stdout.split("\n") if line.startswith("== ")] == [
        f"== {tmp_path}/s{n}.py" for n in range(5)
    ]
    assert (
        told.stdout.endswith("5 files: 4 all ✓, 1 not all ✓\n") and told.returncode == 1 and told.stderr == ""
    )
    alone = polhode("grade", tmp_path / "s3.py", "--exercise", "2", "--seed", "7")
    assert alone.stdout.split("\n", 1)[1] in told.stdout  # the same questions, the same lines


@pytest.mark.slow
def test_a_full_disk_is_no_verdict(folder):
    """Neither where we print nor where we write."""
    with open("/dev/full", "w") as full:
        command = [*COMMAND, "grade", folder / "right_terms.py", "--exercise", "2"]
        printed = subprocess.run(
            command, env=BUFFERED, stdout=full, stderr=subprocess.PIPE, text=True, check=False
        )
    assert printed.returncode == 2 and "No space left on device" in printed.stderr


@pytest.mark.parametrize(
    "arguments",
    [
        pytest.param(("assignments",), marks=pytest.mark.slow),
        ("grade", "nowhere.py"),
        pytest.param(("grade", "right_terms.py", "--exercise", "2"), marks=pytest.mark.slow),
    ],
    ids=" ".join,
)
def test_a_full_disk_below_the_log_is_no_verdict(folder, arguments):
    """A traceback that cannot be printed would end with Python's own exit code,
    which is an answer of ours.
    """
    with open("/dev/full", "w") as full:
        told = subprocess.run(
            [*COMMAND, *arguments], cwd=folder, env=BUFFERED, stdout=full, stderr=full, check=False
        )
    assert told.returncode == 2


@pytest.mark.slow
def test_names_of_files_cost_nobody_a_report_and_are_no_lines_of_ours(polhode, folder, tmp_path):
    """Of bytes that are no UTF-8, and of several lines, also where a file is refused; where nobody can print
    a ✓.
    """
    for name in (b"no\xff.py", b"a\n::error::b.py"):
        Path(os.fsdecode(os.fsencode(tmp_path) + b"/" + name)).write_text(
            (folder / "right_terms.py").read_text()
        )
    Path(os.fsdecode(os.fsencode(tmp_path) + b"/x\n::error::c.py")).write_bytes(b"\0")
    written = [part for form in ("csv", "junit", "out") for part in (f"--{form}", tmp_path / "told" / form)]
    told = polhode("grade", tmp_path, "--exercise", "2", "--jobs", "1", *written, encoding="ascii")
    assert told.returncode == 1 and "3 files: 2 all \\u2713, 1 no submission" in told.stdout, told.stderr
    assert not [line for line in f"{told.stdout}\n{told.stderr}".split("\n") if line.startswith("::")]
    assert (
        len(list((tmp_path / "told" / "out").glob("*/report.json"))) == 2
        and len(list((tmp_path / "told").iterdir())) == 3
    )
    told = polhode("grade", tmp_path, "--exercise", "2", "--jobs", "1", "--json", encoding="ascii")
    assert [bool(r["report"]) for r in json.loads(told.stdout)["reports"]] == [True, True, False]


@pytest.mark.slow
def test_a_reader_that_goes_away_gets_no_verdict(folder):
    files = [folder / "right_terms.py", folder / "right_all.py", folder / "wrong_zeros.py"]
    command = [*COMMAND, "grade", *files, "--exercise", "2", "--jobs", "1"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as running:
        running.stdout.readline()
        running.stdout.close()
        assert running.wait(60) == 141 and running.stderr.read() == b""


@pytest.mark.slow
def test_a_lost_process_is_a_fault_of_the_files_it_had(folder, tmp_path):
    files = [folder / "hostile_endless.py", folder / "hostile_memory.py", folder / "right_terms.py"]
    command = [*COMMAND, "grade", *files, "--exercise", "2", "--jobs", "2", "--json"]
    running = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 30
    while len(hands := children(running.pid)) < 2:
        assert time.monotonic() < deadline
        time.sleep(0.01)
    os.kill(hands[0], signal.SIGKILL)
    stdout, stderr = running.communicate(timeout=60)
    reports = json.loads(stdout)["reports"]
    assert running.returncode == 2 and "a grading process was lost" in stderr
    assert any("system_fault" in r for r in reports) and all(
        bool(r["report"]) != bool(r.get("system_fault")) for r in reports
    )


def children(pid):
    """Processes it has forked that are still Python; its guests are none."""
    found = (p for p in Path("/proc").iterdir() if p.name.isdigit())
    return [int(p.name) for p in found if _parent(p) == pid and _command(p) == _command(Path(f"/proc/{pid}"))]


def _parent(process):
    try:
        return int((process / "stat").read_text().rsplit(")", 1)[1].split()[1])
    except OSError:
        return None


def _command(process):
    try:
        return (process / "cmdline").read_bytes()
    except OSError:
        return None


@pytest.mark.slow
def test_an_interrupted_batch_leaves_no_process(folder):
    files = [folder / "hostile_endless.py", folder / "hostile_memory.py"]
    command = [*COMMAND, "grade", *files, "--exercise", "2", "--jobs", "2"]
    heard = {
        "preexec_fn": lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)
    }  # whoever runs us may ignore it
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, **heard) as running:
        deadline = time.monotonic() + 30
        while len(hands := children(running.pid)) < 2:
            assert time.monotonic() < deadline
            time.sleep(0.01)
        time.sleep(0.5)  # what comes while a process forks may be lost
        running.send_signal(signal.SIGINT)
        assert running.wait(15) == 130
    assert not [h for h in hands if Path(f"/proc/{h}").exists()]


def test_whatever_goes_wrong_before_a_command_is_no_verdict(folder, tmp_path):
    for library in ("numpy", "scipy"):
        (tmp_path / library).mkdir()
        (tmp_path / library / f"{library}.py").write_text(f"raise ImportError('no {library} here')")
        environment = os.environ | {"PYTHONPATH": f"{tmp_path / library}:{os.environ.get('PYTHONPATH', '')}"}
        command = [*COMMAND, "grade", folder / "right_terms.py"]
        result = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
        assert result.returncode == 2 and f"no {library} here" in result.stderr


def test_a_terminal_shows_how_far_it_is_and_other_readers_do_not(polhode, folder):
    terminal, end = os.openpty()
    with open(end, "w") as stderr:
        files = [folder / "right_terms.py", folder / "wrong_zeros.py"]
        told = polhode("grade", *files, "--exercise", "2", "--jobs", "1", stderr=stderr)
    shown = b""
    with (
        open(terminal, "rb", buffering=0) as screen,
        contextlib.suppress(OSError),
    ):  # EIO after the last of it
        while part := screen.read(1 << 16):
            shown += part
    shown = shown.decode()
    assert (
        "\r\x1b[K0 of 2 graded" in shown
        and "2 of 2 graded, 1 all ✓ so far" in shown
        and shown.endswith("\r\x1b[K")
    )
    assert "graded" not in told.stdout and told.returncode == 1


def test_a_fault_exits_with_2_and_is_no_verdict(tmp_path, capsys):
    folder = copied(tmp_path, "pendulum")
    # it runs here, and fails in the child before it reads the submission
    change(folder / "notebook.ipynb", "import numpy as np", "import numpy as np; __import__('reference')")
    mine = folder / "samples/right_terms.py"
    with known(folder):
        assert main(["grade", str(mine), "--assignment", "pendulum", "--json"]) == 2
    (told,) = json.loads(capsys.readouterr().out)["reports"]
    assert (
        told["report"] is None and "before the submission ran" in told["system_fault"] and "error" not in told
    )
