"""The page of one submission: failing lines, motions, timeline and difference, who sees what; a stranger's
text stays text.
"""

import html.parser
import io
import json
import re
import time
import urllib.error
import urllib.request
import uuid

import numpy as np
import pytest

from exercises.authoring.assignments import validation
from polhode.judging.outcome import Diagnosis, Ended, ExerciseReport, SceneEnd
from service.grading.figures import motion_data, rendering
from service.grading.submission import Submission, source_locations
from service.http.templating import ENVIRONMENT
from service.pages.submission.source_view import MOST_LINES, MOST_WORK, TooLong, cells, difference, marks
from service.store.people import people, tokens
from service.store.submissions import speed_vs_accuracy
from service.store.submissions.artefacts import store_artefacts
from tests.support.database import run, sql
from tests.support.reports import outcome, report
from tests.support.submissions import grade_really, graded

SLUG = "/v1/assignments/rigid-body/submissions"
RIGHT = "def euler_eqs(t, w, I):\n    return np.cross(I * w, w) / I\n"
REVERSED = "def euler_eqs(t, w, I):\n    return -np.cross(I * w, w) / I\n"
MOST_BYTES = 10 * 1024


@pytest.fixture(scope="module")
def send(server, url, sandbox):
    """Submit with a token and grade that as a worker does; the submission as the server returns it."""

    def sent(token, source, filename="mine.py", exercises=("2",)):
        body = {"source": source, "filename": filename, "exercises": list(exercises)}
        status, _, told = call(
            server, SLUG, token, json.dumps(body).encode(), Content_Type="application/json"
        )
        assert status == 202, told
        id = json.loads(told)["id"]
        run(url, lambda database: grade_really(database, id, sandbox, {"grade": 1000.0, "pack": 10.0}))
        status, _, told = call(server, f"/v1/submissions/{id}", token)
        assert status == 200, told
        return json.loads(told)

    return sent


@pytest.fixture(scope="module")
def ann(url):
    return token(url, "ann")


@pytest.fixture(scope="module")
def prof(url):
    run(
        url,
        inside(lambda connection: people.enroll(connection, [("prof", "instructor"), ("tina", "assistant")])),
    )
    return token(url, "prof")


def inside(action):
    async def begun(database):
        async with database.begin() as connection:
            return await action(connection)

    return begun


def token(url, name):
    return run(
        url,
        inside(
            lambda connection: tokens.create(
                connection, name, label="test", scopes=tokens.SCOPES, seconds=1000.0
            )
        ),
    )


def call(server, path, token, body=None, **headers):
    given = {"Authorization": f"Bearer {token}", "Accept": "text/html"} | {
        k.replace("_", "-"): v for k, v in headers.items()
    }
    try:
        with urllib.request.urlopen(
            urllib.request.Request(server.url + path, body, given), timeout=90
        ) as answer:
            return answer.status, answer.headers, answer.read().decode()
    except urllib.error.HTTPError as error:
        with error:
            return error.code, error.headers, error.read().decode()


def page(server, token, sent):
    status, headers, told = call(server, f"/submissions/{sent['id']}", token)
    assert status == 200 and "default-src 'self'" in headers["content-security-policy"]
    return told


def notebook(*sources):
    made = [
        {"cell_type": "code", "source": s, "metadata": {}, "outputs": [], "execution_count": None}
        for s in sources
    ]
    text = {"cell_type": "markdown", "source": ["# raise here"], "metadata": {}}
    return json.dumps({"cells": [text, *made], "metadata": {}, "nbformat": 4, "nbformat_minor": 5})


def marked(told):
    """(class, id, line, address and words of the marks) of the lines that have a mark."""
    found = re.findall(r'<span class="([a-z-]+)" id="(line-\d+-\d+)" data-line="(\d+)">(.*?)</span>', told)
    return [
        (kind, id, int(line), re.findall(r'href="#([a-z]+-\d+)">◀ ([^<]*)<', rest))
        for kind, id, line, rest in found
    ]


def test_the_line_that_raised_is_marked_and_linked_with_its_ending(server, ann, send):
    source = "A = '\x0c'  # a form feed begins no line\n\n\ndef deeper(w):\n    return w['no']\n\n\n"
    source += "def euler_eqs(t, w, I):\n    return deeper(w)\n"
    told = page(server, ann, send(ann, source))
    deep, way = marked(told)
    assert deep[:3] == ("failing", "line-1-5", 5) and way[:3] == ("caller", "line-1-9", 9)
    assert deep[3] == [("cause-1", "raised here")] and way[3] == [("cause-1", "called from here")]
    assert told.count("IndexError: only integers") == 1 and 'id="cause-1"' in told
    assert '<a href="#line-1-5">mine.py, line 5</a>' in told and "w[<mark>" not in told
    assert "<summary>traceback</summary>" in told, "two lines of the student led there"


def test_in_a_notebook_the_line_of_the_right_cell_is_marked(server, ann, send):
    sent = send(
        ann,
        notebook("a = 1\nb = 2", "def euler_eqs(t, w, I):\n    return w / a.b", "def (:\n    pass"),
        "mine.ipynb",
    )
    told = page(server, ann, sent)
    assert "<h3>cell 1</h3>" in told and "3 cells" in told
    (_, second, _, raised), (_, third, _, syntax) = marked(told)
    assert (second, third) == ("line-2-2", "line-3-1")
    assert raised == [("cause-1", "raised here")]
    assert syntax[0][0] == "end-0" and syntax[0][1].startswith("raised here: SyntaxError"), (
        "no check needs it"
    )


def test_a_line_is_counted_as_python_counts_it_and_only_frames_are_believed():
    source = "a = 1\r\nb = 2\rc = 3\x0b\u2028 # still 3\n\x0cd = 4\n\n"
    forged = (
        '  File "submission.py", line 4, in f\n    d = 4\nValueError: x\n'
        '  File "submission.py", line 1, in g\n'
    )
    scene_end = SceneEnd("probes", Ended.RAISED, "ValueError: x", "raises", forged)
    (cell,) = cells(Submission(source), marks(report(scene_ends=[scene_end])))
    assert [line.number for line in cell.lines if line.marks] == [4] and len(cell.lines) == 5
    assert cell.lines[2].text == "c = 3\ufffd\ufffd # still 3" and cell.lines[3].text == "\ufffdd = 4"
    far = SceneEnd(
        "probes",
        Ended.RAISED,
        "x",
        "raises",
        f'  File "submission.py", line {10**30}, in f\n  File "/etc/passwd", line 1',
    )
    shown = cells(Submission(source), marks(report(scene_ends=[far])))
    assert not [line for cell in shown for line in cell.lines if line.marks]
    assert source_locations(SceneEnd("film", Ended.TIMED_OUT, "too slow")) == []


def test_a_long_source_is_shown_in_part_and_its_marked_line_always():
    long = Submission("\n".join(f"x{k} = {k}" for k in range(9000)))
    assert [(len(c.lines), c.left_out) for c in cells(long, {})] == [(MOST_LINES, 9000 - MOST_LINES)]
    raised = SceneEnd(
        "submission.py",
        Ended.RAISED,
        "E: e",
        "raises",
        '  File "submission.py", line 8000, in <module>\nE: e\n',
    )
    (cell,) = cells(long, marks(report(scene_ends=[raised])))
    assert cell.lines[-1].number == 8000 and cell.lines[-1].marks and cell.left_out == 1000


def test_the_exact_motion_and_the_students_own(server, ann, rigid_body, send):
    right, wrong = (send(ann, source, exercises=("2", "5", "6")) for source in (RIGHT, REVERSED))
    for name, scene in (("torque-free", "torque-free"), ("tumble", "spin-mid"), ("precession", "precession")):
        told = {}
        for sent in (right, wrong):
            path = f"/submissions/{sent['id']}/motions/{name}.json"
            assert f'data-motion="{path}"' in page(server, ann, sent)
            status, headers, body = call(server, path, ann)
            assert (
                status == 200
                and headers["content-type"] == "application/json"
                and len(body.encode()) <= MOST_BYTES
            )
            assert call(server, path, ann, If_None_Match=headers["etag"])[0] == 304
            told[sent["id"]] = json.loads(body)
        exact, reverse = told[right["id"]], told[wrong["id"]]
        truth = rigid_body.scene(scene).truth(rigid_body.scene(scene).inputs)
        assert np.abs(matrices(exact["exact"], exact["scale"]) - at(truth, exact["t"])).max() < 4e-4
        assert exact["yours"] == exact["exact"] == reverse["exact"] != reverse["yours"]
        assert exact["notes"] == ["Never more than 0.00001° apart."] and re.search(
            r"by \d+(\.\d+)?°", reverse["notes"][0]
        )
        assert (
            len(exact["t"]) == min(motion_data.FRAMES, len(truth["t"]))
            and abs(np.linalg.norm(exact["L"]) - 1) < 1e-3
        )
    assert call(server, f"/submissions/{right['id']}/motions/nope.json", ann)[0] == 404
    assert call(server, f"/submissions/{uuid.uuid4()}/motions/tumble.json", ann)[0] == 404


def matrices(whole, scale):
    from scipy.spatial.transform import Rotation

    return Rotation.from_quat(np.array(whole).reshape(-1, 4) / scale, scalar_first=True).as_matrix()


def at(truth, ms):
    return truth["R"][np.abs(truth["t"][None] * 1e3 - np.array(ms)[:, None]).argmin(axis=1)]


def spoilt(R, kind):
    R = R.copy()
    match kind:
        case "nan":
            R[40:] = np.nan
        case "inf first":
            R[0] = np.inf
        case "huge":
            R[50:] *= 1e300
        case "reflected":
            R *= -1
        case "zero":
            R[30] = 0
        case "slightly off":
            R *= 1.01
    return R


@pytest.mark.parametrize(
    ("kind", "frames", "words"),
    [
        ("nan", 40, "your R is not finite"),
        ("inf first", 0, "At t = 0 s your R is not finite."),
        ("huge", 50, "max |RᵀR − 1| = inf"),
        ("reflected", 0, "a reflection, not a rotation"),
        ("zero", 30, "max |RᵀR − 1| = 1"),
        ("slightly off", 80, "the nearest rotation is shown"),
    ],
)
def test_what_is_no_rotation_is_said_and_not_shown(rigid_body, kind, frames, words):
    scene, asked = rigid_body.scene("precession"), motion_data.find(rigid_body, "precession")
    R = spoilt(scene.truth(scene.inputs)["R"], kind)
    told = json.loads(motion_data.to_json(rigid_body, asked, {"R": R}, 3))
    assert (
        len(told["yours"]) == 4 * frames and len(told["exact"]) == 4 * 80 and words in " ".join(told["notes"])
    )


@pytest.mark.parametrize(
    "R",
    [
        None,
        np.zeros((3, 3)),
        np.zeros((80, 3, 3), complex),
        np.zeros((80, 9)),
        np.zeros((80, 3, 3), np.uint8),
    ],
)
def test_arrays_that_are_none_of_the_scene_are_refused(rigid_body, R):
    with pytest.raises(ValueError, match="no attitude"):
        motion_data.to_json(
            rigid_body, motion_data.find(rigid_body, "precession"), {} if R is None else {"R": R}, 3
        )


def test_quaternions_are_those_of_the_rotations_and_do_not_jump():
    from scipy.spatial.transform import Rotation

    random = Rotation.random(4000, rng=3).as_matrix()
    half_turns = Rotation.from_rotvec(np.pi * np.eye(3)).as_matrix()
    R = np.concatenate([random, half_turns, [np.eye(3)]])
    q = motion_data.quaternions(R)
    assert np.abs(Rotation.from_quat(q, scalar_first=True).as_matrix() - R).max() < 1e-14
    assert (np.einsum("ij,ij->i", q[1:], q[:-1]) >= 0).all()


def test_no_motion_is_larger_than_ten_kib(rigid_body):
    """Every number as long as it can be, and all that can be told at once."""
    for exercise in rigid_body.exercises:
        for one in exercise.motions:
            scene = rigid_body.scene(one.scene)
            R = 1.02 * scene.truth(scene.inputs)["R"]
            R[-1] = np.nan
            told = json.loads(motion_data.to_json(rigid_body, one, {"R": R}, 3))
            assert len(told["notes"]) == 3
            longest = (
                told
                | {key: [-motion_data.SCALE] * 4 * motion_data.FRAMES for key in ("exact", "yours")}
                | {"t": [999999] * motion_data.FRAMES}
            )
            assert len(json.dumps(longest, ensure_ascii=False, separators=(",", ":")).encode()) <= MOST_BYTES


def test_a_report_that_cannot_be_read_is_our_fault_and_no_missing_submission(server, ann, url, send):
    sent = send(ann, RIGHT + "# no report")
    of = "grading_id = (SELECT id FROM grading WHERE submission_id = %s)"
    sql(url, "ALTER TABLE result DISABLE TRIGGER USER")
    sql(url, f"UPDATE result SET report = report - 'provenance' WHERE {of}", sent["id"])
    sql(url, "ALTER TABLE result ENABLE TRIGGER USER")
    for path in (f"/submissions/{sent['id']}", f"/v1/submissions/{sent['id']}"):
        status, _, told = call(server, path, ann)
        assert status == 500 and "polhode failed (our error)" in told


def test_where_an_assignments_own_code_failed_is_shown_to_the_staff_only(server, ann, prof, url):
    body = json.dumps({"source": RIGHT + "# no grading", "exercises": ["2"]}).encode()
    id = json.loads(call(server, SLUG, ann, body, Content_Type="application/json")[2])["id"]
    fault = (
        "all 3 runs failed (assignment rigid-body has an error: scene probes: plays.py line 3: KeyError: 'x')"
    )
    sql(
        url,
        "INSERT INTO result (grading_id, fault) SELECT id, %s FROM grading WHERE submission_id = %s",
        fault,
        id,
    )
    for path in (f"/submissions/{id}", f"/v1/submissions/{id}"):
        (_, _, student), (_, _, staff) = call(server, path, ann), call(server, path, prof)
        assert "plays.py line 3" in staff and "plays.py" not in student
        assert "assignment rigid-body has an error: the course staff can see where" in student


def test_forged_arrays_in_the_store_are_a_404_or_a_sentence(server, ann, url, rigid_body, send):
    sent = send(ann, RIGHT + "# forged", exercises=("6",))
    grading = sql(url, "SELECT id FROM grading WHERE submission_id = %s", sent["id"])[0][0]
    path = f"/submissions/{sent['id']}/motions/precession.json"

    def put(**arrays):
        stream = io.BytesIO()
        np.savez(stream, **arrays)
        mark = uuid.uuid4().hex
        sql(url, "INSERT INTO artefact (sha256, content) VALUES (%s, %s)", mark, stream.getvalue())
        sql(
            url,
            "UPDATE grading_artefact SET sha256 = %s WHERE grading_id = %s AND name = 'arrays.npz'",
            mark,
            grading,
        )

    put(**{"probes/wdot": np.zeros(3)})
    assert call(server, path, ann)[0] == 404
    put(**{"precession/R": np.full((80, 3, 3), np.nan)})
    status, _, body = call(server, path, ann)
    assert (
        status == 200
        and json.loads(body)["yours"] == []
        and json.loads(body)["notes"] == ["At t = 0 s your R is not finite."]
    )


def test_a_motion_needs_a_scene_that_brings_an_attitude(rigid_body):
    from dataclasses import replace

    last = rigid_body.exercises[-1]
    wrong = replace(last, motions=(replace(last.motions[0], scene="symmetric"),))
    assert "motion precession: scene symmetric does not return R" in validation.errors(
        replace(rigid_body, exercises=(wrong,))
    )


def test_the_timeline_leads_to_the_others_and_to_what_changed(server, url, prof, send):
    ben = token(url, "ben")
    first = send(ben, RIGHT)
    second = send(ben, RIGHT.replace("return ", "# now with a sign\n    return -") + "print('<b>')\n")
    told = page(server, ben, second)
    rows = re.findall(
        r"<tr( class=\"current\")?>\s*<th scope=\"row\"><a href=\"/submissions/([0-9a-f-]+)\"", told
    )
    assert [(bool(current), id) for current, id in rows] == [(True, second["id"]), (False, first["id"])]
    status, _, changes = call(server, f"/submissions/{second['id']}/diff", ben)
    assert (
        status == 200
        and len(re.findall(r'<span class="gone"', changes)) == 1
        and len(re.findall(r'<span class="new"', changes)) == 3
    )
    assert (
        "+</span>     # now with a sign" in changes
        and "−</span>     return np.cross" in changes
        and "print(&#39;&lt;b&gt;&#39;)" in changes
    )
    assert call(server, f"/submissions/{first['id']}/diff", ben)[0] == 404
    assert call(server, f"/submissions/{second['id']}/diff", prof)[0] == 200
    cara = token(url, "cara")
    for path in (
        f"/submissions/{second['id']}",
        f"/submissions/{second['id']}/diff",
        f"/submissions/{second['id']}/motions/torque-free.json",
    ):
        assert call(server, path, cara)[0] == 403


def test_a_difference_is_of_the_code_and_tells_lines_before_and_now():
    same = difference(Submission(RIGHT), Submission(RIGHT))
    assert same == []
    before, now = (
        Submission(notebook("a = 1", middle, "c = 3"), "x.ipynb") for middle in ("b = 2", "b = 2\nb = 3")
    )
    (group,) = difference(before, now)
    assert [(line.kind, line.before, line.now, line.text) for line in group if line.kind != "same"] == [
        ("new", None, 5, "b = 3")
    ]
    assert ("same", 3, 3, "# cell 2") in [(line.kind, line.before, line.now, line.text) for line in group]


def test_what_was_submitted_can_be_downloaded_by_who_may_see_it(server, ann, url, send):
    sent = send(ann, RIGHT + "# ω", 'ω "mine".py')
    status, headers, told = call(server, f"/submissions/{sent['id']}/source", ann)
    assert status == 200 and told == RIGHT + "# ω"
    assert headers["content-disposition"] == "attachment; filename*=UTF-8''%CF%89%20%22mine%22.py"
    assert f'href="/submissions/{sent["id"]}/source"' in page(server, ann, sent)
    assert call(server, f"/submissions/{sent['id']}/source", token(url, "cara"))[0] == 403


def test_no_two_sources_take_long_to_compare():
    """Lines that are all alike, that repeat just below what difflib leaves aside, that only move, and a
    quarter million of them.
    """
    rng = np.random.default_rng(1)
    pairs = [
        (["x"] * 1999 + ["y"], ["z"] + ["x"] * 1999),
        ([str(k) for k in range(2000)], [str(k) for k in range(2000)][::-1]),
    ]
    for lines, kinds in ((2000, 105), (1400, 150), (2000, 520), (199, 2), (199, 20), (1990, 400)):
        pairs.append(tuple([[str(k) for k in rng.integers(0, kinds, lines)] for _ in "ab"]))
    pairs.append(([""] * 262_000 + ["a"], ["b"] + [""] * 262_000))
    refused = 0
    for a, b in pairs:
        began = time.process_time()
        try:
            difference(Submission("\n".join(a)), Submission("\n".join(b)))
        except TooLong:
            refused += 1
        assert time.process_time() - began < 3.0
    assert 2 <= refused < len(pairs) and MOST_WORK <= 1e8


def test_two_sources_too_unlike_are_said_to_be(server, url, send):
    dan = token(url, "dan")
    for sign in "ab":
        sent = send(dan, "\n".join(f"# {sign}{k}" for k in range(2500)) + "\n" + RIGHT)
    assert "too much for a line-by-line comparison" in call(server, f"/submissions/{sent['id']}/diff", dan)[2]


def test_staff_see_who_and_how_and_a_student_what_concerns_them(server, ann, prof, url, send):
    sent = send(ann, REVERSED)
    sql(url, "UPDATE person SET full_name = 'Ann Müller' WHERE name = 'ann'")
    mine, theirs, assistants = (
        page(server, ann, sent),
        page(server, prof, sent),
        page(server, token(url, "tina"), sent),
    )
    seed = str(sent["report"]["provenance"]["seed"])
    of_staff = [
        seed,
        "Ann Müller",
        '<span class="badge">hidden</span>',
        "allowed limit 1e-06: the notebook",
        "; margin ",
        '<th scope="col">Worker',
    ]
    for words in of_staff:
        assert words in theirs and words in assistants and words not in mine, words
    for words in (
        '<span class="name">ω(t) follows the exact motion</span> <span class="got">max|Δ|/scale',
        "sign-reversed",
        "Phases: ",
        "<caption>Gradings of this submission",
        "public checks: 2 of 3",
    ):
        assert words in theirs and words in mine, words
    assert re.search(r"<td>\d+(\.\d)? m?s</td>\s*<td>\d+(\.\d)? m?s</td>", mine), "waited and took"


COPIED = """
WITH s AS (
    INSERT INTO submission (id, assignment_id, person_id, source, sha256, filename, fingerprint)
    SELECT gen_random_uuid(), assignment_id, person_id, source, sha256, filename, fingerprint FROM submission
      WHERE id = %s
    RETURNING id
), a AS (
    INSERT INTO grading (id, submission_id, number, kind, seed, max_runs)
    SELECT gen_random_uuid(), id, 1, 'interactive', 1, 3 FROM s RETURNING id
), r AS (
    INSERT INTO result (grading_id, fault, cancelled_by) SELECT id, %s, %s FROM a
) SELECT id FROM s
"""


def test_what_somebody_stopped_is_not_called_our_failure(server, ann, url, send):
    sent = send(ann, RIGHT + "# stopped")
    ours, stopped = ({"id": sql(url, COPIED, sent["id"], "told here", by)[0][0]} for by in (None, "prof"))
    told = page(server, ann, ours)
    assert "Grading failed (our error)" in told and "told here" in told and "! failed (our error)" in told
    told = page(server, ann, stopped)
    assert (
        "Cancelled by prof. It does not count" in told
        and "our error" not in told
        and "cancelled by prof<" in told
    )


NASTY = (
    "<script>alert(1)</script><img src=x"
    " onerror=alert(2)>\"'><svg/onload=alert(3)>&lt;b&gt;{{7*7}}</pre></span>"
)
BIDI = "\u202e\u2066"


class Tags(html.parser.HTMLParser):
    def __init__(self, told):
        super().__init__()
        self.tags, self.attributes, self.addresses = [], [], []
        self.feed(told)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += [name for name, _ in attrs]
        self.addresses += [
            value for name, value in attrs if name in ("href", "src", "data-live", "data-motion", "action")
        ]


def test_the_notebooks_own_checks_are_lines_without_points(server, ann, send):
    told = send(ann, notebook(RIGHT, "validate.check(True, '<b>mine</b>', '1 < 2')"), "mine.ipynb")
    (check,) = told["report"]["notebook_checks"]
    assert (
        check["line"] == "✓  <b>mine</b>   [1 < 2]"
        and check["cell"] == "cell 2"
        and told["report"]["score"] == 5
    )
    shown = page(server, ann, told)
    assert (
        "Self-reported, no points" in shown
        and '&lt;b&gt;mine&lt;/b&gt; <span class="badge">cell 2</span>' in shown
        and '<span class="got words">1 &lt; 2</span>' in shown
        and "<b>mine" not in shown
    )


def test_speed_vs_accuracy_is_offered_where_it_can_be_measured(server, ann, url, send):
    failing = "def euler_eqs(t, w, I):\n    raise ValueError\n"
    measured, raises, other = (
        send(ann, *one) for one in ((RIGHT + "# fast",), (failing,), (RIGHT, "a.py", ("1",)))
    )
    offered = [
        f"/v1/submissions/{one['id']}/sweep.svg" in page(server, ann, one)
        for one in (measured, raises, other)
    ]
    assert offered == [True, False, False]
    waiting = page(server, ann, measured)
    assert 'data-reload="speed"' in waiting and "Being measured while a worker is idle" in waiting
    grading = sql(url, "SELECT id FROM grading WHERE submission_id = %s", measured["id"])[0][0]
    run(
        url,
        lambda database: store_artefacts(
            database, grading, {speed_vs_accuracy.REFUSED: b"<b> took too long"}
        ),
    )
    shown = page(server, ann, measured)
    assert "Could not be measured: &lt;b&gt; took too long." in shown and "sweep.svg" not in shown


def test_a_strangers_text_stays_text(server, url, send):
    eve = token(url, f"eve {NASTY}")
    source = f"# {NASTY} {BIDI}\nprint({NASTY + BIDI!r})\n\n"
    source += f"def euler_eqs(t, w, I):\n    raise ValueError({NASTY + BIDI!r})  # {NASTY}{BIDI}\n"
    script = type(f"{NASTY}", (), {}).__name__
    send(
        eve,
        f"E = type({script!r}, (Exception,), {{}})\n\ndef euler_eqs(t, w, I):\n    raise E({BIDI!r})\n",
        f"{NASTY}.py",
    )
    sent = send(eve, source, f"<script>{BIDI}'\"><b>.py")
    for path in (f"/submissions/{sent['id']}", f"/submissions/{sent['id']}/diff"):
        status, _, told = call(server, path, eve)
        found = Tags(told)
        assert status == 200 and found.tags.count("script") == 1 and "b>" not in found.tags, path
        assert found.tags.count("svg") <= 1, "only the ring"
        assert not [name for name in found.attributes if name.startswith("on") or name == "style"]
        assert not [address for address in found.addresses if not address.startswith(("/", "#", "data:,"))]
        assert not set(BIDI) & set(told) and "49" not in re.findall(r"\{\{.{0,5}\}\}|&gt;49&lt;", told)
        assert "&lt;script&gt;" in told and "\ufffd" in told
    assert Tags(page(server, eve, sent)).tags.count("img") == sum(
        len(sent["report"][kind]) for kind in ("figures", "animations")
    )


def test_pictures_and_motions_of_one_grading_come_from_the_same_arrays(server, ann, rigid_body, url, send):
    sent = send(ann, RIGHT + "# same", exercises=("6",))
    grading = sql(url, "SELECT id FROM grading WHERE submission_id = %s", sent["id"])[0][0]
    packed = sql(
        url,
        "SELECT content FROM artefact JOIN grading_artefact USING (sha256) WHERE grading_id = %s AND name ="
        " 'arrays.npz'",
        grading,
    )[0][0]
    seen = rendering.unpack(packed)["precession"]
    made = motion_data.to_json(
        rigid_body, motion_data.find(rigid_body, "precession"), seen, sent["report"]["provenance"]["seed"]
    )
    path = f"/submissions/{sent['id']}/motions/precession.json"
    assert call(server, path, ann)[2].encode() == made
    assert sql(
        url,
        "SELECT 1 FROM grading_artefact WHERE grading_id = %s AND name = 'motions/precession.json'",
        grading,
    ) == [(1,)]


def test_points_are_out_of_all_there_are(server, url, ann):
    id = graded(url, "ann", "+-", total=36, max_points=36, bonus_points=6, not_attempted=["1", "6"])
    told = call(server, f"/submissions/{id}", ann)[2]
    assert "<b>1</b> of 36, +0 of 6 bonus points" in told and "public checks: 1 of 2" in told
    assert re.findall(r'title="[^"]+: not attempted">– Exercise (\d)<', told) == ["1", "3", "4", "5", "6"]
    newest = json.loads(call(server, SLUG, ann)[2])["submissions"][0]
    assert (newest["score"], newest["max_score"], newest["total"]) == (1, 2, 36)
    for page in ("/", "/assignments/rigid-body", f"/submissions/{id}"):
        assert "<td>1 of 36" in call(server, page, ann)[2], page
    assert '"total":36' in call(server, f"/v1/submissions/{id}/events", ann)[2].replace(" ", "")


def test_the_page_states_each_cause_once_above_the_lines_that_refer_to_it(server, url, ann):
    slip = Diagnosis("sign-flipped", "ω̇₂ has the opposite sign: check <I₃ − I₁>", 1.0)
    other = Diagnosis("units", "ω is in degrees", 1.0)
    outcomes = [outcome(f"c{k}", "fail", f"label {k}", diagnosis=[slip]) for k in (1, 2)]
    outcomes.append(outcome("c3", "fail", "label 3", diagnosis=[other]))
    id = graded(url, "ann", exercises=[ExerciseReport("2", "Euler", outcomes)])
    page = call(server, f"/submissions/{id}", ann)[2]
    assert page.count("ω̇₂ has the opposite sign: check &lt;I₃ − I₁&gt;") == 1
    assert page.count('href="#cause-1"') == 2 and page.count('href="#cause-2"') == 1
    first = page.index("<h2>Fix this first</h2>")
    assert first < page.index("ω̇₂ has") < page.index('id="cause-2"') < page.index("Exercise 2. Euler")
    assert '<a href="#check-c1">label 1</a>; <a href="#check-c2">label 2</a>' in page


def test_exercises_that_fail_for_the_same_cause_are_one_folded_line(server, url, ann):
    slip = Diagnosis("sign-flipped", "ω̇₂ has the opposite sign", 1.0)
    exercises = [
        ExerciseReport(n, "Euler", [outcome(f"c{n}", "fail", "f is right", diagnosis=[slip])]) for n in "2345"
    ]
    page = call(server, f"/submissions/{graded(url, 'ann', exercises=exercises)}", ann)[2]
    assert re.findall(r"<details( id=\"exercise-\d\")?( open)?>\s*<summary><span class=\"mark", page) == [
        (' id="exercise-2"', " open"),
        ("", ""),
    ]
    assert "<h2>Exercises 3–5: the same cause, 3 checks</h2>" in page
    assert 'id="exercise-4"' in page and 'href="#exercise-4"' in page
    assert "counts in each of exercises 2–5" in page


def test_the_page_says_whether_the_submission_counts(server, url):
    gil = token(url, "gil")
    ids = [graded(url, "gil", verdicts) for verdicts in ("+--", "++-", "+--")]
    shown = [call(server, f"/submissions/{id}", gil)[2] for id in ids]
    assert "this one counts" in shown[1] and "one counts, with" not in shown[1]
    link = f'<a href="/submissions/{ids[1]}">2 points</a>'
    assert (
        f"a later one counts, with {link}" in shown[0] and f"an earlier one counts, with {link}" in shown[2]
    )


@pytest.mark.parametrize(
    ("points", "total", "shown"),
    [
        (2, 2, '<span class="pass">✓ 2 of 2</span>'),
        (3, 2, '<span class="pass">✓ 3 of 2, bonus included</span>'),
        (1, 2, "1 of 2"),
        (0, 0, "no points"),
    ],
)
def test_points_of_an_assignment_without_any_have_no_verdict(points, total, shown):
    macros = ENVIRONMENT.get_template("macros.html").module
    assert macros.points({"points": points, "max_score": total, "total": total}, total) == shown
