"""``polhode.submit`` and what a notebook then displays, against a real server that answers by a script."""

import atexit
import json
import sys

import pytest
from IPython.core.displaypub import DisplayPublisher
from IPython.core.interactiveshell import InteractiveShell
from traitlets.config import Config

import polhode
from polhode.client import remote
from polhode.client.kit_hash import build
from polhode.client.transport import http
from polhode.judging.outcome import Picture
from polhode.report.dataclass_json import document
from tests.support.fake_server import Scripted, browser, event, hangs_up, problem, says, streams
from tests.support.reports import outcome, report

PNG = b"\x89PNG of 1 kB"
PICTURES = [Picture(name, "1", f"Figure {name}", f"{name} over time") for name in ("alpha", "beta", "gamma")]
GRADED = report([outcome("1-notebook", label="moments match")], figures=PICTURES, total=1)
SUBMITTED = {"id": "7", "status": "queued", "late": False, "sha256": "0", "report": None}
ANSWERS = [
    says(202, SUBMITTED),
    says(200, {"kit_build": build()}),
    streams(event("graded", "1", score=1)),
    says(200, SUBMITTED | {"status": "graded", "report": document(GRADED)}),
]


class Recorder(DisplayPublisher):
    """What is displayed, and how many requests the server had seen then."""

    def publish(self, data, metadata=None, **_):
        self.displayed.append((len(self.server.seen), data["text/plain"], data["text/html"]))


@pytest.fixture
def submitted(monkeypatch, tmp_path):
    """Submit a file in an IPython shell to a server whose further answers are given; return what the shell
    then displays of it.
    """
    monkeypatch.setattr(http, "FIRST_PAUSE_S", 0.05)
    monkeypatch.setattr(remote, "PICTURE_S", 0.1)
    for name in ("http_proxy", "no_proxy", "HTTP_PROXY", "NO_PROXY"):
        monkeypatch.delenv(name, raising=False)
    config, main, server = Config(), sys.modules["__main__"], Scripted()
    config.HistoryManager.enabled = False
    config.HistoryManager.hist_file = ":memory:"
    InteractiveShell.clear_instance()
    shell = InteractiveShell.instance(config=config, display_pub_class=Recorder)
    shell.display_pub.displayed, shell.display_pub.server = [], server
    (tmp_path / "mine.py").write_text("x = 1\n")

    def submit(*pictures):
        server.script += [*ANSWERS, *pictures]
        found = polhode.submit(file=tmp_path / "mine.py", server=server.url, assignment="rigid-body")
        assert len(server.seen) == len(ANSWERS), "no picture is requested before the report is displayed"
        shell.user_ns["report"] = found
        assert shell.run_cell("report").success
        return shell.display_pub.displayed

    submit.shell, submit.server = shell, server
    yield submit
    server.stop()
    InteractiveShell.clear_instance()
    atexit.unregister(shell.atexit_operations)
    sys.modules["__main__"] = main


def picture(content=PNG):
    return says(200, content, "image/png")


def test_lines_are_displayed_before_the_first_picture_is_requested(submitted):
    (before, lines, markup), (after, plain, whole) = submitted(picture(), picture(b"<svg/>"), picture())
    assert (before, lines) == (len(ANSWERS), GRADED.lines())
    assert "moments match" in markup and 'src="data:image' not in markup
    assert after == before + 3, "what was displayed is replaced when all pictures are there"
    assert plain.split("\n")[1:] == [f"Figure {p.name}: {p.name} over time" for p in PICTURES]
    assert (whole.count('src="data:image/png'), whole.count('src="data:image/svg')) == (2, 1)
    exercise = whole.index("Exercise 1.")
    assert exercise < whole.index('src="data:image') < whole.rindex("</details>"), "inside their exercise"
    assert submitted.shell.user_ns["report"].drawn("alpha") == PNG
    submitted.shell.run_cell("report")
    assert len(submitted.server.seen) == before + 3, "what is displayed again is not fetched again"


@pytest.mark.parametrize("waits", [True, False], ids=["waiting", "synchronous"])
def test_the_kernel_of_a_web_page_displays_the_same(submitted, monkeypatch, waits):
    for name, module in browser(waits=waits).items():
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.setattr(sys, "platform", "emscripten")
    ANSWERS_THERE = [*ANSWERS[:2], ANSWERS[3], ANSWERS[3]]
    monkeypatch.setattr(sys.modules[__name__], "ANSWERS", ANSWERS_THERE)
    lines, whole = submitted(picture(), picture(), picture())
    assert lines[1] == GRADED.lines() and whole[0] - lines[0] == whole[2].count("data:image/png") == 3


def test_a_picture_that_cannot_be_drawn_is_one_line_and_the_others_come(submitted):
    missing = problem(404, "not-found", "the figure cannot be drawn from these numbers: inf")
    _, (_, plain, markup) = submitted(missing, picture(), picture())
    gone = "Figure alpha is missing: The figure cannot be drawn from these numbers: inf."
    assert gone in plain and f"<p>{gone}</p>" in markup and markup.count('src="data:image') == 2


@pytest.mark.parametrize(
    "answer", [hangs_up, problem(401, "nobody", "no token"), problem(503, "busy", "again", Retry_After="9")]
)
def test_a_server_that_sends_no_pictures_is_one_line_for_all_that_are_missing(submitted, answer):
    lines, (_, plain, markup) = submitted(picture(), answer)
    gone = plain.split("\n")[-1]
    assert lines[1] == GRADED.lines() and markup.count('src="data:image') == 1
    assert gone.startswith("2 of 3 pictures are missing: ") and submitted.server.url in gone
    submitted.server.script[:] = [picture()]
    submitted.shell.run_cell("report")
    shown = [markup.count('src="data:image') for _, _, markup in submitted.shell.display_pub.displayed[2:]]
    assert shown == [0, 3], "what failed is asked for again"


def test_a_terminal_gets_the_lines_and_nothing_is_fetched(submitted, capsys):
    submitted.shell.display_formatter.active_types = ["text/plain"]
    assert submitted() == [] and len(submitted.server.seen) == len(ANSWERS)
    assert capsys.readouterr().out.splitlines()[-1] == f"Out[0]: {GRADED.lines()}"


def test_a_front_end_that_asks_for_html_gets_the_pictures_in_it(submitted):
    submitted.shell.display_formatter.active_types = ["text/plain"]
    submitted(picture(), problem(404, "not-found", "no"), picture())
    markup = submitted.shell.user_ns["report"]._repr_html_()
    assert markup.count("data:image/png") == 2 and "Figure beta is missing: No." in markup


def test_the_progress_ends_with_the_points(submitted, capsys):
    submitted(picture())
    assert (
        capsys.readouterr().out.splitlines()[-2]
        == "submitted and graded: 1 of 1 points (public checks: 1 of 1)"
    )
    assert json.loads(submitted.server.seen[0].body) == {"source": "x = 1\n", "filename": "mine.py"}


def test_a_repetition_is_not_submitted_and_again_submits_it(submitted, capsys, tmp_path):
    last = SUBMITTED | {"submitted_at": "2026-01-02T03:04:05+00:00", "repeated": True, "status": "graded"}
    submitted.server.script += [says(200, last), *ANSWERS[1:], *ANSWERS]
    given = {"file": tmp_path / "mine.py", "server": submitted.server.url, "assignment": "rigid-body"}
    found = polhode.submit(**given)
    assert "Not submitted again: your submission of 2026-01-0" in found.remark and found.score == GRADED.score
    assert "not submitted again: 1 of 1 points" in capsys.readouterr().out
    assert "Not submitted again" not in polhode.submit(**given, again=True).remark
    preferred = [
        request.headers.get("prefer") for request in submitted.server.seen if request.method == "POST"
    ]
    assert preferred == ["no-repeat", None]
