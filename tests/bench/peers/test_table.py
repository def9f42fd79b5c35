"""What the comparison with other autograders makes of their answers and of the clock; ``make bench`` installs
the peers themselves.

The files in tests/peers are what the peers and polhode left of a real run.
"""

import sys
from pathlib import Path

import nbformat
import pytest

from bench.forms import FORMS
from bench.peers import check50, gradescope, nbgrader, otter, polhode, table
from bench.peers.__main__ import PEERS
from bench.peers.clock import CommandFailed, Row, Timing, clock
from bench.peers.conservation import COMMON, ENERGY, INTEGRATE, MOMENTUM
from bench.peers.environment import requirements
from bench.peers.goals import ONE, SERVER, WHOLE, goals, limits
from bench.peers.judging import answers, sound, verdicts
from bench.peers.peer import Command, Marks, NoMarks, Peer, Workspace, clean_environment
from bench.peers.rounds import Case, graded, measure
from bench.peers.submissions import SAMPLES, file_name, submissions

LEFT = Path(__file__).parent / "outputs"
READERS = (
    check50.read,
    gradescope.read,
    lambda file: nbgrader.read(file, "right"),
    lambda file: polhode.read(file, "zeros"),
)


@pytest.mark.parametrize(("name", "most"), [("check50", 1), ("gradescope", 2), ("otter", 2)])
def test_marks_are_read_from_what_a_peer_left(name, most):
    read = check50.read if name == "check50" else gradescope.read
    assert read(LEFT / f"{name}-right.json") == Marks(most, most)
    assert read(LEFT / f"{name}-sign-slip.json") == Marks(0, most)


def test_marks_are_read_from_nbgraders_export_and_our_reports():
    assert nbgrader.read(LEFT / "nbgrader.csv", "right") == Marks(2, 2)
    assert nbgrader.read(LEFT / "nbgrader.csv", "sign-slip") == Marks(0, 2)
    assert polhode.read(LEFT / "polhode-zeros.json", "zeros") == Marks(2, 5)


@pytest.mark.parametrize(
    "text",
    [
        None,
        "",
        "{}",
        "[1]",
        "null",
        '{"tests": [{"max_score": 2}]}',
        '{"reports": [{"file": "zeros.py", "report": null}]}',
    ],
)
@pytest.mark.parametrize("read", READERS)
def test_no_answer_is_no_marks(read, text, tmp_path):
    if text is not None:
        (tmp_path / "left").write_text(text)
    with pytest.raises(NoMarks):
        read(tmp_path / "left")


def test_a_student_who_is_not_in_the_export_has_no_marks():
    with pytest.raises(NoMarks):
        nbgrader.read(LEFT / "nbgrader.csv", "nobody")


def passes(submission):
    names = {}
    exec(f"{submission.script}\n{COMMON}\n{INTEGRATE}", names)
    return eval(ENERGY, names), eval(MOMENTUM, names), names


def test_the_peers_checks_integrate_and_are_those_of_the_notebook():
    sent = submissions(2)
    for kind, accepted in {
        "right": True,
        "copy-1": True,
        "sign slip": False,
        "zeros": True,
        "reversed in time": True,
    }.items():
        energy, momentum, names = passes(sent[file_name(kind)])
        assert (bool(energy), bool(momentum)) == (accepted, accepted), kind
    energy, momentum, names = passes(sent["right"])
    assert names["w"].shape == (3, 3100)
    assert 0 < names["drift"](names["T_rot"](names["w"], names["body"])) < 1e-12


def test_submissions_are_scripts_and_valid_notebooks_of_the_same_text():
    sent = submissions(3)
    assert {file_name(kind) for kind in SAMPLES} | {*FORMS, "copy-0", "copy-1", "copy-2"} == set(sent)
    for submission in sent.values():
        cells = nbformat.reads(submission.notebook, as_version=4).cells
        assert "\n\n".join(c.source for c in cells) == submission.script
        nbformat.validate(nbformat.reads(nbgrader.graded_notebook(submission), as_version=4))


@pytest.mark.parametrize(
    "text",
    [check50.CHECKS, gradescope.TESTS, otter.TESTS, otter.LOOP, nbgrader.ENERGY_CELL, nbgrader.MOMENTUM_CELL],
)
def test_what_is_given_to_peers_is_python(text):
    compile(text, "given", "exec")


@pytest.mark.parametrize("peer", PEERS)
def test_requirements_are_pinned_and_name_no_host(peer):
    lines = requirements(peer.package).read_text().splitlines()
    assert all(line.count("==") == 1 and "/" not in line and "@" not in line for line in lines)
    pinned = dict(line.split("==") for line in lines)
    assert (pinned["numpy"], pinned["scipy"], pinned["matplotlib"]) == ("2.4.6", "1.17.1", "3.11.2")


def test_nothing_of_ours_reaches_into_a_peers_environment(monkeypatch):
    for name in ("PYTHONPATH", "PYTHONDONTWRITEBYTECODE", "POLHODE_DATA", "VIRTUAL_ENV", "MPLBACKEND"):
        monkeypatch.setenv(name, "1")
    cleaned = clean_environment(Path("/nowhere"), Path("/tools"))
    assert not {"PYTHONPATH", "PYTHONDONTWRITEBYTECODE", "POLHODE_DATA", "VIRTUAL_ENV", "MPLBACKEND"} & set(
        cleaned
    )
    assert cleaned["HOME"] == "/nowhere"
    assert cleaned["PATH"].startswith("/tools:")


def here(tmp_path, *codes):
    place = Workspace(
        Path(sys.executable), tmp_path, clean_environment(tmp_path, Path(sys.executable).parent)
    )
    return [Command([sys.executable, "-S", "-c", code], tmp_path) for code in codes], place


def test_the_clock_counts_waiting_and_work_of_grandchildren_too(tmp_path):
    busy = "import time\nwhile time.process_time() < 0.3: pass"
    commands, place = here(
        tmp_path,
        "import time; time.sleep(0.3)",
        f"import subprocess, sys; subprocess.run([sys.executable, '-S', '-c', {busy!r}])",
    )
    waited, worked = clock(commands[:1], place), clock(commands[1:], place)
    assert waited.wall >= 0.3 > waited.cpu
    assert worked.cpu >= 0.3


UNCOUNTED = """
import os, signal, time
signal.signal(signal.SIGCHLD, signal.SIG_IGN)
done, tell = os.pipe()
child = os.fork()
if child == 0:
    while time.process_time() < 0.3:
        pass
    os.write(tell, b"x")
    signal.pause()
os.read(done, 1)
time.sleep(0.3)
os.kill(child, signal.SIGKILL)
"""


def test_the_clock_counts_what_nobody_waits_for(tmp_path):
    """As polhode's guests, which are killed together with their process namespace."""
    commands, place = here(tmp_path, UNCOUNTED)
    took = clock(commands, place)
    assert took.cpu >= 0.2
    assert took.wall < 5


def test_a_command_that_fails_is_told_with_its_last_words(tmp_path):
    commands, place = here(tmp_path, "raise SystemExit('no kernel')")
    with pytest.raises(CommandFailed, match="ended with 1: no kernel"):
        clock(commands, place)
    clock(commands, place, codes=())


def row(name, what, count, *walls):
    return Row(name, what, count, [Timing(w, w / 2) for w in walls])


ROWS = [
    row(SERVER, ONE, 1, 0.1, 0.09, 0.5),
    row("polhode grade", "10: one command", 10, 1.0),
    row(SERVER, "10: sent at once", 10, 0.2),
    row("polhode grade", ONE, 1, 0.55),
    row("slow", ONE, 1, 9.0, 8.2, 8.1),
    row("slow", "10: a loop", 10, 41.0),
    row("fast", ONE, 1, 0.7),
    row("fast", "10: a loop", 10, 7.0),
]


def test_goals_are_ratios_of_medians_in_one_run():
    assert list(map(str, goals(ROWS, [("slow", 1 / 50), ("absent", 1 / 50)], 10))) == [
        "met      one over HTTP: at most 1/50.0 of slow: 1/82.0 (CPU 1/82.0)",
        "not measured  one over HTTP: at most 1/50.0 of a tool that is absent",
        "not met  one over HTTP: at most 1/10.0 of fast: 1/7.0 (CPU 1/7.0)",
        "met      10 at once over HTTP, each: at most 1/20.0 of fast: 1/35.0 (CPU 1/35.0)",
        "met      one by polhode grade: at most 0.80 of fast: 0.79 (CPU 0.79)",
        "not met  10 by polhode grade, each: at most 1/8.0 of fast: 1/7.0 (CPU 1/7.0)",
    ]
    assert all(str(goal).startswith("not measured") for goal in goals(ROWS[:4], [], 10))


def test_goals_in_seconds():
    assert limits([row(SERVER, ONE, 1, 0.06), row(SERVER, WHOLE, 1, 0.4), row("other", WHOLE, 1, 0.1)]) == [
        "met      one over HTTP, CPU time: at most 0.035 s: 0.030 s",
        "not met  a whole notebook over HTTP: at most 0.3 s: 0.400 s",
    ]


TIMES = """\
| tool              | what                 | wall s | least – greatest | CPU s | wall s each | CPU s each |
|-------------------|----------------------|--------|------------------|-------|-------------|------------|
| polhode over HTTP | one of fifteen forms | 0.100  | 0.090 – 0.500    | 0.050 | 0.100       | 0.050      |
| polhode grade     | 10: one command      | 1.000  | 1.000 – 1.000    | 0.500 | 0.100       | 0.050      |"""


def test_tables():
    assert table.times(ROWS[:2]) == TIMES
    given = {
        "ours": {"right": Marks(5, 5), "zeros": Marks(2, 5)},
        "theirs": {"right": Marks(2.0, 2.0), "zeros": "no answer"},
    }
    assert (
        table.verdicts(["right", "zeros"], given) == "| submission | ours    | theirs    |\n"
        "|------------|---------|-----------|\n"
        "| right      | **5/5** | **2/2**   |\n"
        "| zeros      | 2/5     | no answer |"
    )


def test_a_tool_is_sound_if_it_tells_right_from_a_slip():
    assert sound({"right": Marks(2, 2), "sign slip": Marks(1, 2)})
    assert not sound({"right": Marks(1, 2), "sign slip": Marks(0, 2)})
    assert not sound({"right": Marks(2, 2), "sign slip": Marks(2, 2)})
    assert not sound({"right": Marks(0, 0), "sign slip": Marks(0, 2)})
    silent = {"right": Marks(2, 2), "sign slip": "no answer"}
    assert not sound(silent)
    assert not answers(silent)


class Strict(Peer):
    """Gives a mark for what takes the moments apart and none for other texts; has no answer where np.max is
    mentioned.
    """

    name, batch = "strict", "a loop"

    def prepare(self, submissions):
        for name, submission in submissions.items():
            (self.workspace.folder / name).write_text(submission.answer)
        return []

    def one(self, name):
        code = f"text = open({name!r}).read(); print('np.max' in text or int('I1, I2, I3 = I' in text))"
        return Command(
            [sys.executable, "-S", "-c", code], self.workspace.folder, self.workspace.folder / f"{name}.out"
        )

    def marks(self, name):
        text = (self.workspace.folder / f"{name}.out").read_text().strip()
        if text == "True":
            raise NoMarks("np.max")
        return Marks(int(text), 1)


def test_every_kind_is_judged_and_timed_ones_must_be_right(tmp_path, capsys):
    _, place = here(tmp_path)
    tool, sent = Strict(place), submissions(1)
    given = verdicts([tool], sent)["strict"]
    assert list(given) == list(SAMPLES)
    assert (given["right"], given["zeros"], given["np.max patched"]) == (
        Marks(1, 1),
        Marks(0, 1),
        "no answer",
    )
    assert "strict, np.max patched: np.max" in capsys.readouterr().out
    assert len(graded(tool, [tool.one("right")], ["right"])) == 1
    with pytest.raises(NoMarks, match="zeros rejected"):
        graded(tool, [tool.one("zeros")], ["zeros"])


def test_a_tool_that_cannot_be_prepared_has_no_answers(tmp_path, capsys):
    class Broken(Strict):
        def prepare(self, submissions):
            return [
                Command([sys.executable, "-S", "-c", "raise SystemExit('no kernel')"], self.workspace.folder)
            ]

    given = verdicts([Broken(here(tmp_path)[1])], submissions(1))
    assert set(given["strict"].values()) == {"no answer"}
    assert "strict: ended with 1: no kernel" in capsys.readouterr().out


def test_rounds_take_turns_and_leave_out_what_breaks(capsys):
    order = []

    def takes(name, fails_at=None):
        def run():
            order.append(name)
            if order.count(name) == fails_at:
                raise CommandFailed("no kernel")
            return [Timing(1.0, 1.0)]

        return Case(name, ONE, 1, run)

    rows = measure([takes("a"), takes("b", fails_at=2), takes("c")], 3)
    assert order == ["a", "b", "c", "a", "b", "c", "a", "c"]
    assert [(r.name, len(r.taken)) for r in rows] == [("a", 3), ("c", 3)]
    assert f"b, {ONE}: not measured: no kernel" in capsys.readouterr().out
