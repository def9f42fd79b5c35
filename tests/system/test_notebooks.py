"""Real notebooks, executed by nbclient against a running server: what a student types and what they see."""

import ast
import json
import re
import signal
import threading
import time
import urllib.request
from itertools import takewhile

import pytest

from service.store.people import tokens
from service.store.postgres.server import running_url
from tests.support import course_notebook
from tests.support.database import run, sql
from tests.support.http_client import Browser
from tests.support.server import WebApplication

pytestmark = pytest.mark.filterwarnings("default")  # those of zmq and of event loops are not ours
SETUP = (
    "import numpy as np\nimport matplotlib.pyplot as plt\nfrom matplotlib.animation import FuncAnimation\n"
    "import polhode\n"
)
EULER = """\
def euler_eqs(t, w, I):
    return np.array([
        (I[1] - I[2]) * w[1] * w[2] / I[0],
        (I[2] - I[0]) * w[2] * w[0] / I[1],
        (I[0] - I[1]) * w[0] * w[1] / I[2],
    ])
"""
HELPED = "def euler_eqs(t, w, I):\n    return np.array([rate(w, I, i) for i in range(N)])\n"
HELPER = (
    "def rate(w, I, i):\n    j, k = (i + 1) % N, (i + 2) % N\n    return (I[j] - I[k]) * w[j] * w[k] / I[i]\n"
)
LINE = re.compile(r"[✓✗–]  \S.*   \[.*\]")


@pytest.fixture
def play(kit, tmp_path, monkeypatch):
    """Execute cells in a fresh kernel that has the kit and nothing else of ours; the outputs of each cell."""
    for name in ("HOME", "XDG_CONFIG_HOME", "XDG_CACHE_HOME", "IPYTHONDIR", "MPLCONFIGDIR"):
        monkeypatch.setenv(name, str(tmp_path / name.lower()))
    monkeypatch.setenv("PYTHONPATH", str(kit))
    monkeypatch.setenv("PYTHONSAFEPATH", "1")

    import nbformat  # takes seconds, and only the process that runs these tests needs it
    from nbclient import NotebookClient

    def execute(*cells, allow_errors=False):
        notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in cells])
        resources = {"metadata": {"path": str(tmp_path)}}
        NotebookClient(
            notebook, timeout=120, kernel_name="python3", allow_errors=allow_errors, resources=resources
        ).execute()
        return [cell.outputs for cell in notebook.cells]

    return execute


def connect(server):
    return f'{SETUP}polhode.connect("{server.url}", assignment="rigid-body")'


def shown(outputs):
    """What the cell's last expression shows; of a report, its lines and what its pictures show."""
    return next(
        o.data["text/plain"]
        for o in outputs
        if o.output_type == "execute_result" or "text/html" in o.get("data", {})
    )


def report_lines(outputs):
    """The ✓/✗ lines of a report, without the texts of its pictures, which follow them."""
    lines = list(takewhile(lambda line: line.startswith(("✓", "✗", "–")), shown(outputs).split("\n")))
    assert lines
    return lines


def page(outputs):
    """The HTML that a cell shows: a report, and then its pictures."""
    return "".join(o.get("data", {}).get("text/html", "") for o in outputs)


def said(outputs):
    """What an error says, or what was printed."""
    return "".join("\n".join(o.traceback) if o.output_type == "error" else o.get("text", "") for o in outputs)


def line(outputs):
    """The last state of the one line of progress."""
    return next(o.data["text/plain"] for o in outputs if o.output_type == "display_data")


def fetch(server, path):
    with urllib.request.urlopen(server.url + path, timeout=30) as answer:
        return answer.read().decode()


@pytest.mark.slow  # so does the course notebook below
def test_local_and_remote_tell_the_same_lines(server, play):
    *_, local, remote = play(
        connect(server), EULER, 'polhode.check("2")', 'polhode.submit(euler_eqs, exercises=["2"])'
    )
    lines = report_lines(remote)
    assert all(LINE.fullmatch(line) for line in lines) and len(lines) == 5
    assert report_lines(local) == lines[:3] and all(line.startswith("✓") for line in lines)
    assert line(remote) == "submitted and graded: 5 of 5 points (public checks: 3 of 3)"
    html = page(remote)
    assert html.count("data:image/png;base64,") == 2 and "Graded source (SHA-256 " in html
    assert "def euler_eqs(t, w, I):" in html and f'href="{server.url}/submissions/' in html
    assert "The server makes 2 more checks" in page(local)


@pytest.mark.slow
def test_a_wrong_sign_is_named_and_the_plain_text_stays_lines(server, play):
    *_, remote, told = play(
        connect(server),
        EULER.replace("(I[2] - I[0])", "-(I[2] - I[0])"),
        "r = polhode.submit(euler_eqs); r",
        "print(r)",
    )
    assert "Fix this first" in page(remote) and "<code>likely sign-flipped</code>" in page(remote)
    assert "sign-flipped" not in shown(remote) and "likely sign-flipped" in said(told)


@pytest.mark.slow
@pytest.mark.parametrize(
    "cells",
    [
        ["%%time\n" + EULER],
        ["N = 3\n" + HELPED, HELPER],
        ["N = 3", HELPER.replace("- I[k]", "+ I[k]"), HELPED, "%%capture\n" + HELPER],
        [EULER.replace("- I[2]", "+ I[2]"), EULER],
        [
            "import functools",
            f"@functools.cache\ndef three():\n    return 3\n{HELPER}{HELPED}".replace("N", "three()"),
        ],
    ],
    ids=["%%time", "helper after it", "helper redefined", "redefined", "decorated"],
)
def test_what_is_defined_anywhere_in_the_notebook_goes_along(cells, server, play):
    *_, remote = play(connect(server), *cells, 'report = polhode.submit(euler_eqs, exercises=["2"])\nreport')
    assert all(line.startswith("✓") for line in report_lines(remote))


@pytest.mark.slow
def test_the_whole_notebook_goes_and_its_own_calls_do_nothing_there(server, play, tmp_path):
    import nbformat

    cells = [
        connect(server),
        "1 / 0",
        EULER,
        'polhode.check("2")',
        "report = polhode.submit()\n[(e.scene, e.sentence) for e in report.scene_ends if e.traceback]",
        "report.passed, report.score",
    ]
    *_, scene_ends, verdict = play(*cells, allow_errors=True)
    assert shown(scene_ends) == "[('cell 2', 'ZeroDivisionError: division by zero')]"
    assert shown(verdict).startswith("(True, ")
    notebook = nbformat.v4.new_notebook(
        cells=[nbformat.v4.new_code_cell(SETUP), nbformat.v4.new_code_cell(EULER)]
    )
    notebook.cells[0].outputs = [nbformat.v4.new_output("stream", text="x" * 400_000)]
    nbformat.write(notebook, tmp_path / "mine.ipynb")
    *_, remote = play(connect(server), 'polhode.submit(file="mine.ipynb", exercises=["2"])')
    assert shown(remote).count("✓") == 5


@pytest.mark.slow
def test_the_courses_own_notebook_runs_in_a_kernel_and_prints_its_nine_lines(server, play):
    cells = course_notebook.code()
    _, *played = play(connect(server), *cells.values())
    outputs = dict(zip(cells, played, strict=True))
    lines = [line for id in cells if id.startswith("validation") for line in said(outputs[id]).splitlines()]
    assert [line.split("   ")[0] for line in lines] == [f"✓  {label}" for label in course_notebook.LABELS]
    assert all(shown(outputs[id]) == "True" for id in cells if id.startswith("validation"))
    card = outputs["header"][0].data["text/html"]
    assert "Rigid-Body Rotation and the Spinning Top" in card and "advanced" in card and outputs["footer"]
    assert "<script" in page(outputs["solution-5"]), "an animation is shown as a player"


@pytest.mark.slow
def test_what_cannot_be_sent_is_named_and_empty_functions_stay_at_home(server, play):
    cells = [
        "data = open('/dev/null')",
        EULER + "    data",
        "def box_moments(m, a, b, c):\n    '''Moments.'''\n    ...\n",
    ]
    wrong = ["polhode.submit(np.cross)", "polhode.submit(euler_eqs, file='mine.py')"]
    calls = ["polhode.submit(box_moments)", *wrong, "polhode.submit(euler_eqs, box_moments)"]
    *_, nothing, other, both, remote = play(connect(server), *cells, *calls, allow_errors=True)
    assert "Nothing was submitted: `cross` is not among the functions of rigid-body" in said(
        other
    ) and "euler_eqs" in said(other)
    assert said(both) == "Submit either functions or a file, not both: nothing was submitted."
    assert (
        said(nothing)
        == "Nothing was submitted: `box_moments` has no code yet. Write it, run its cell, and submit again.\n"
    )
    html = page(remote)
    assert "Not sent, still empty: box_moments." in html and re.search(r"<p>data: ", html)


@pytest.mark.slow
def test_attempts_tell_what_changed(new_server, tmp_path, play, database_url):
    server = new_server(tmp_path / "data", POLHODE_DATABASE_URL=database_url, POLHODE_WORKERS="1")
    submit = 'polhode.submit(euler_eqs, exercises=["2"])'
    *_, found, _ = play(
        connect(server),
        EULER.replace("- I[2]", "+ I[2]"),
        submit,
        EULER,
        submit,
        "polhode.submissions()",
        "len(polhode.submissions())",
    )
    newest, first = shown(found).split("\n")
    # a wrong equation may keep the solver busy beyond its time
    flips = r"(5 checks ✗ → ✓|4 checks ✗ → ✓; 1 check – → ✓)"
    assert (
        re.search(rf"  5 of 36 \+ 6 bonus  best, latest  lines \+1 −1; {flips}$", newest)
        and "0 of 36 + 6 bonus" in first
    )
    listed = fetch(server, "/assignments/rigid-body")
    assert listed.count('href="/submissions/') == 2 and re.search(flips, listed) and "(best)" in listed
    server.stop()


@pytest.mark.slow
def test_a_server_that_is_killed_and_started_again_in_mid_wait(new_server, tmp_path, play):
    server, begun = new_server(tmp_path / "data", POLHODE_WORKERS="1"), threading.Event()

    def kill_and_start_again():
        while "running" not in fetch(server, "/") and not begun.wait(0.1):
            continue
        server.stop(signal.SIGKILL)
        time.sleep(1.0)
        new_server(tmp_path / "data", port=server.port, POLHODE_WORKERS="1")

    harm = threading.Thread(target=kill_and_start_again)
    harm.start()
    *_, remote = play(
        connect(server), "import time", "time.sleep(1.5)\n" + EULER, 'polhode.submit(exercises=["2"])'
    )
    begun.set()
    harm.join()
    assert shown(remote).count("✓") == 5
    assert fetch(server, "/").count('href="/submissions/') == 1, (
        "one submission, however often it was asked for"
    )


@pytest.fixture
def asking(server, monkeypatch):
    """A server beside the one that grades, on its database, which asks who somebody is."""
    monkeypatch.setattr("service.auth.device_login.INTERVAL_S", 0.5)
    with WebApplication(running_url(server.data), identity="token") as application:
        yield application


# logins of a notebook: test_identity.py and test_entrance.py; the kit's calls: test_transport.py
@pytest.mark.slow
def test_login_revoked_and_offline(server, asking, tmp_path, play):
    database_url = running_url(server.data)

    async def give(database):
        async with database.begin() as connection:
            await connection.execute("UPDATE assignment SET published = true WHERE slug = 'rigid-body'")
            return await tokens.create(connection, "ann", label="t", scopes=tokens.SCOPES, seconds=600.0)

    course = run(database_url, give)

    def codes():
        return {code for (code,) in sql(database_url, "SELECT user_code FROM device_login")}

    before = codes()

    def confirm():
        while not (waiting := codes() - before):
            time.sleep(0.1)
        login = f"/login?code={waiting.pop()}"
        Browser(asking).send(login, login, token=course)

    student = threading.Thread(target=confirm)
    student.start()
    submit = 'polhode.submit(euler_eqs, exercises=["2"])'
    cells = [
        EULER,
        submit,
        "polhode.login()",
        submit,
        "polhode.login()",
        "polhode.logout()",
        submit,
        'polhode.connect("http://polhode.invalid")',
        submit,
        'polhode.check("2")',
    ]
    outputs = play(connect(asking), *cells, allow_errors=True)
    student.join()
    _, _, unknown, login, graded, again, _, after, _, offline, local = outputs
    assert "You are not logged in at" in said(unknown) and "run polhode.login()" in said(unknown)
    health = f"{asking.url} is ready. Deadline: none. Submissions used: "
    assert line(login) == "Logged in as ann." and shown(graded).count("✓") == 5
    assert health + "0." in said(login) and said(again) == f"Logged in as ann.\n{health}1.\n"
    assert "You are not logged in at" in said(after) and "Traceback" not in said(after)
    assert (
        "polhode.invalid" in said(offline)
        and "Traceback" not in said(offline)
        and shown(local).count("✓") == 3
    )
    kept = tmp_path / "xdg_config_home" / "polhode" / "tokens.json"
    assert kept.stat().st_mode & 0o077 == 0 and json.loads(kept.read_text()) == {}
    saved = json.dumps(outputs)
    assert re.findall(".{0,80}polhode_.{0,80}", saved) == [], "no token in what is saved with the notebook"


def solutions(rigid_body):
    """Functions of right samples by name, as source."""
    found = {}
    for name in ("right_all.py", "right_tumble_box_polys.py"):
        source = (rigid_body.folder / "samples" / name).read_text()
        found |= {
            node.name: ast.get_source_segment(source, node)
            for node in ast.parse(source).body
            if isinstance(node, ast.FunctionDef)
        }
    return found


CELLS = ["as downloaded", "with right functions, without drawings", "with right functions"]


@pytest.mark.slow
@pytest.mark.parametrize("which", CELLS)
def test_the_course_notebook_as_the_server_gives_it(which, server, play, tmp_path, monkeypatch, rigid_body):
    """Its %pip cell installs the kit from the server that runs; nothing of ours is there before.

    Without drawings means that animations stay empty and no cell shows a figure: these take longer than all
    others.
    """
    (tmp_path / "installed").mkdir()
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "installed"))
    monkeypatch.setenv("PIP_TARGET", str(tmp_path / "installed"))
    monkeypatch.setenv("PIP_NO_DEPS", "1")
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    cells = [
        c
        for c in json.loads(fetch(server, "/v1/assignments/rigid-body/notebook.ipynb"))["cells"]
        if c["cell_type"] == "code"
    ]
    if "without" in which:
        cells = [c for c in cells if c["metadata"].get("tags") and c["id"] not in ("ex5-check", "ex6-check")]
    right = {} if which == "as downloaded" else solutions(rigid_body)
    right = {
        name: source
        for name, source in right.items()
        if not ("without" in which and name.startswith("animate"))
    }
    sources = []
    for cell in cells:
        source = "".join(cell["source"])
        name = re.match(r"def (\w+)", source)
        sources.append(
            right.get(name[1], source) if name and "solution" in cell["metadata"].get("tags", []) else source
        )
    sources[1] = "%matplotlib inline\n" + sources[1]
    sources = [
        source.replace("\n# polhode.submit", "\npolhode.submit") for source in sources
    ]  # as a student does who wants to submit
    outputs = dict(zip([c["id"] for c in cells], play(*sources), strict=True))
    assert sources[0].count(server.url) == 2 and f"{server.url} is ready. Deadline: none." in said(
        outputs["install"]
    )
    if which == "as downloaded":
        assert "Nothing was submitted: " in said(outputs["submit"])
        assert "[not measured: euler_eqs returned None: is a return statement missing?]" in shown(
            outputs["ex2-check"]
        )
        return
    remote = report_lines(outputs["submit"])
    local = [line for id in outputs if id.endswith("-check") for line in report_lines(outputs[id])]
    assert all(line.startswith("✓") for line in remote), remote
    assert [line for line in remote if line in local] == local and len(local) < len(remote)
