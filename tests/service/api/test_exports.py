"""Exports from a real database by a real server: who may, and what stands in them."""

import csv
import io
import json
import time
import urllib.error
import urllib.request
import uuid
import zipfile
from dataclasses import replace

import pytest

from polhode.judging.outcome import Ended, ExerciseReport, Outcome, SceneEnd, Tolerance
from polhode.judging.verdict import Verdict
from polhode.report.report import Provenance, Report
from service.grading.submission import Submission
from service.store.people import people, tokens
from service.store.queue import runs
from service.store.submissions.accepting import accept
from tests.support.database import new, run, sql

SLUG = "/assignments/rigid-body"
FORMS = ("nbgrader", "canvas", "moodle", "gradescope")
PATHS = (
    "/grades.csv",
    *(
        f"{SLUG}/{name}"
        for name in (
            "grades.csv",
            "grades.json",
            "all.zip",
            "submissions.zip",
            *(f"grades/{f}.csv" for f in FORMS),
        )
    ),
)
STATES = {
    "pass": Verdict.PASS,
    "fail": Verdict.FAIL,
    "timeout": Verdict.UNMEASURED,
    "error": Verdict.UNMEASURED,
}
ENDINGS = {"timeout": Ended.TIMED_OUT, "error": Ended.RAISED}
EVIL, TWIN = "=HYPERLINK(1)/../x", "=HYPERLINK(1)_.._x"


def report(**states):
    """With a check for each, its id with a dash after the first character."""
    asked = {"reason": "none", "limit": 1.0}
    outcomes = [
        Outcome(
            id=f"{k[1]}-{k[3:]}",
            label=k,
            verdict=STATES[s],
            detail="",
            tolerance=Tolerance(**asked),
            cause=s if s in ENDINGS else None,
        )
        for k, s in states.items()
    ]
    endings = [SceneEnd(s, ending, s) for s, ending in ENDINGS.items() if s in states.values()]
    made = Provenance(seed=7, versions={"polhode": "0.1.0"}, isolation="process")
    total = sum(o.points for o in outcomes if o.counted)
    return Report("rigid-body", "1", [ExerciseReport("2", "Two", outcomes)], made, total, scene_ends=endings)


async def graded(database, who, made, source="x", filename="submission.py"):
    """A submission of theirs with that report; its id."""
    one = replace(new(who), submission=Submission(source, filename))
    await accept(database, one)
    if made is not None:
        grading = (
            await database.rows("SELECT id FROM grading WHERE submission_id = %(id)s", {"id": one.id})
        )[0].id
        await runs.finish(database, await runs.claim(database, grading, uuid.uuid4(), "w"), made, {})
    return one.id


async def fill(database):
    """A small class; ids of submissions by what they are."""
    told = [
        ("prof", "instructor"),
        ("tess", "assistant"),
        *((name, None) for name in ("ada", "ben", "cho", "dora", "-ann", EVIL, TWIN)),
    ]
    async with database.begin() as connection:
        await people.enroll(connection, told)
    two = report(c2_energy="pass", c2_motion="pass", c9_old="pass")
    found = {"first": await graded(database, "ada", report(c2_energy="fail", c2_motion="timeout"), "x = 1")}
    found["best"] = await graded(database, "ada", two, "x = 2", "../../../report.json")
    found["equal"] = await graded(database, "ada", two, "x = 3")
    found["worse"] = await graded(database, "ada", report(c2_energy="pass", c2_motion="error"), "x = 4")
    found["given"] = await graded(database, "ben", report(c2_energy="fail", c2_motion="error"))
    found["waits"] = await graded(database, "cho", None)
    found["-ann"] = await graded(database, "-ann", report(c2_energy="pass"))
    for k, name in enumerate((EVIL, TWIN)):
        found[name] = await graded(database, name, report(c2_energy="pass"), f"y = {k}")
    found["prof"] = await graded(database, "prof", two)
    return found


@pytest.fixture(scope="module")
def sent(url):
    found = run(url, fill)
    about = "UPDATE person SET full_name = %s, email = %s, student_id = %s WHERE name = %s"
    sql(url, about, "Ada Lovelace", "ada@uni.example", "00815", "ada")
    sql(url, about, '@SUM(1+1),=1\n"x', "+1@uni.example", "-7", EVIL)
    given = (
        "INSERT INTO override (submission_id, check_id, points, reason, given_by) VALUES (%s, %s, %s, %s,"
        " 'prof')"
    )
    sql(url, given, found["given"], "2-energy", 1, "=1+1 is right")
    sql(url, given, found["given"], "9-nothing", 1, "of no effect")
    sql(
        url,
        "INSERT INTO audit (actor, action, subject, detail) VALUES ('prof', 'roster', '=1', '{\"people\":"
        " 7}')",
    )
    return found


@pytest.fixture(scope="module")
def asked(server, url, sent):
    """Ask as a person: status, headers, body."""
    given = {who: run(url, lambda d, who=who: token(d, who)) for who in ("prof", "tess", "ada")}

    def ask(path, who="tess", **headers):
        headers |= {"Authorization": f"Bearer {given[who]}"} if who else {}
        try:
            with urllib.request.urlopen(
                urllib.request.Request(server.url + path, headers=headers), timeout=60
            ) as answer:
                return answer.status, answer.headers, answer.read()
        except urllib.error.HTTPError as error:
            with error:
                return error.code, error.headers, error.read()

    return ask


async def token(database, who):
    async with database.begin() as connection:
        return await tokens.create(connection, who, label="test", scopes=tokens.SCOPES, seconds=1000.0)


def lines(body):
    return list(csv.DictReader(io.StringIO(body.decode("utf-8-sig"), newline="")))


@pytest.mark.parametrize("path", PATHS)
def test_the_staff_may_and_nobody_else(asked, path):
    assert asked(path)[0] == asked(path, "prof")[0] == 200
    status, headers, body = asked(path, "ada")
    assert (status, headers["content-type"]) == (403, "application/problem+json") and b"not-allowed" in body
    assert asked(path, None, Authorization="Bearer polhode_none")[0] == 401


@pytest.mark.parametrize("path", PATHS)
def test_what_a_browser_is_told_about_the_file(asked, path):
    headers = asked(path)[1]
    kind = {"csv": "text/csv; charset=utf-8", "json": "application/json", "zip": "application/zip"}[
        path.rpartition(".")[2]
    ]
    assert headers["content-type"] == kind and headers["cache-control"] == "no-store"
    assert headers["x-content-type-options"] == "nosniff"
    name = path.removeprefix(SLUG).strip("/").replace("/", "-").removeprefix("grades-").partition(".")
    stem, today = (
        f"{'rigid-body' if SLUG in path else 'course'}-{name[0]}",
        time.strftime("%Y-%m-%d", time.gmtime()),
    )
    assert (
        headers["content-disposition"]
        == f"attachment; filename=\"{stem}-{today}.{name[2]}\"; filename*=UTF-8''{stem}-{today}.{name[2]}"
    )


def test_what_is_not_there(asked):
    assert asked("/assignments/none/grades.csv")[0] == asked("/assignments/none/all.zip")[0] == 404
    assert asked(f"{SLUG}/grades/excel.csv")[0] == 422


def test_grades_of_the_best_submission_of_each_student(asked, sent, rigid_body):
    _, _, body = asked(f"{SLUG}/grades.csv")
    assert body.startswith(b"\xef\xbb\xbfstudent,")  # a spreadsheet takes it for UTF-8
    found = {line["student"]: line for line in lines(body)}
    assert list(found) == ["'-ann", "'=HYPERLINK(1)/../x", "'=HYPERLINK(1)_.._x", "ada", "ben", "cho", "dora"]
    ada = found["ada"]
    assert (ada["points"], ada["counted"], ada["attempts"], ada["submission"]) == (
        "3",
        "3",
        "4",
        str(sent["equal"]),
    )
    assert (ada["max_points"], ada["grader"]) == (
        str(rigid_body.max_points()),
        "polhode 0.1.0, assignment version 1",
    )
    assert (ada["2-energy"], ada["2-motion"], ada["9-old"], ada["6-secret"]) == ("pass", "pass", "pass", "")
    assert (ada["full_name"], ada["student_id"], ada["late"], ada["overridden"]) == (
        "Ada Lovelace",
        "00815",
        "no",
        "no",
    )
    ben = found["ben"]
    assert (ben["points"], ben["score"], ben["overridden"]) == ("1", "0", "yes")
    assert (ben["2-energy"], ben["2-motion"]) == ("pass (override)", "error")
    assert [found["cho"][name] for name in ("points", "percent", "status", "attempts", "graded_at")] == [
        "",
        "",
        "queued",
        "1",
        "",
    ]
    assert [found["dora"][name] for name in ("points", "late", "status", "attempts", "2-energy")] == [
        "",
        "",
        "none",
        "0",
        "",
    ]
    evil = found["'=HYPERLINK(1)/../x"]
    assert (evil["full_name"], evil["email"], evil["student_id"]) == (
        "'@SUM(1+1),'=1 \"x",
        "'+1@uni.example",
        "'-7",
    )


def test_the_same_as_json_with_texts_as_they_are(asked, sent, rigid_body):
    told = json.loads(asked(f"{SLUG}/grades.json")[2])
    assert (told["assignment"], told["version"], told["max_points"]) == (
        "rigid-body",
        "1",
        rigid_body.max_points(),
    )
    assert [c["id"] for c in told["checks"]] == [c.id for e in rigid_body.exercises for c in e.checks]
    students = {one["student"]: one for one in told["students"]}
    assert students[EVIL]["full_name"] == '@SUM(1+1),=1\n"x' and students[EVIL]["points"] == 1
    assert students["ben"]["checks"] == {
        "2-energy": {"state": "fail", "given": 1, "points": 1, "earned": 0},
        "2-motion": {"state": "error", "given": None, "points": 1, "earned": 0},
    }
    assert sum(check["points"] for check in told["checks"]) == len(told["checks"])
    assert students["dora"]["points"] is None and students["dora"]["checks"] == {} and "prof" not in students


def test_points_given_for_the_whole_submission_decide_which_is_best(asked, url, sent):
    whole = (
        "INSERT INTO override (submission_id, points, reason, given_by) VALUES (%s, 30, 'by mouth', 'prof')"
        " RETURNING id"
    )
    id = sql(url, whole, sent["first"])[0][0]
    try:
        ada = next(line for line in lines(asked(f"{SLUG}/grades.csv")[2]) if line["student"] == "ada")
        assert (ada["points"], ada["score"], ada["submission"], ada["2-motion"]) == (
            "30",
            "0",
            str(sent["first"]),
            "timeout",
        )
    finally:
        sql(url, "UPDATE override SET withdrawn_at = now(), withdrawn_by = 'prof' WHERE id = %s", id)


def test_the_whole_course(asked, rigid_body):
    found = {line["student"]: line for line in lines(asked("/grades.csv")[2])}
    assert found["ada"]["rigid-body points"] == "3" and found["dora"]["rigid-body points"] == ""
    assert {line["rigid-body max_points"] for line in found.values()} == {str(rigid_body.max_points())}


def test_what_other_gradebooks_import(asked, sent, rigid_body):
    forms = {form: asked(f"{SLUG}/grades/{form}.csv")[2] for form in FORMS}
    assert not any(body.startswith(b"\xef\xbb\xbf") for body in forms.values())
    nbgrader, canvas, moodle, gradescope = (lines(forms[form]) for form in FORMS)
    graded = {line["Submission ID"] for line in gradescope if line["Status"] == "Graded"}
    assert len(graded) == 5 and graded < {*map(str, sent.values())}
    assert [line["Status"] for line in gradescope].count("Missing") == 1 and len(gradescope) == 7
    assert len(nbgrader) == 7 and {line["student_id"]: line["score"] for line in nbgrader}["dora"] == "0.0"
    title = "2.6 Rigid-Body Rotation and the Spinning Top"
    assert (canvas[0]["Student"], canvas[0][title]) == ("Points Possible", str(rigid_body.max_points()))
    assert {line["SIS Login ID"]: line[title] for line in canvas[1:]} == {
        line["Username"]: line[title] for line in moodle
    }
    assert len(moodle) == 5 and "dora" not in {line["Username"] for line in moodle}


@pytest.fixture(scope="module")
def archive(asked):
    with zipfile.ZipFile(io.BytesIO(asked(f"{SLUG}/all.zip")[2])) as archive:
        yield archive


@pytest.fixture(scope="module")
def found(archive, sent):
    """A file of one of the submissions sent, or without name what files there are."""
    index = {line["submission"]: line for line in lines(archive.read("rigid-body/submissions.csv"))}
    assert index.keys() == {str(id) for id in sent.values()}

    def find(what, name=None):
        folder = index[str(sent[what])]["folder"]
        return (
            {n.rpartition("/")[2] for n in archive.namelist() if folder in n}
            if name is None
            else archive.read(f"{folder}/{name}")
        )

    return find


def test_the_zip_has_matplotlib_and_leads_nowhere_else(archive, tmp_path):
    assert archive.testzip() is None
    archive.extractall(tmp_path)
    names = archive.namelist()
    assert len(set(map(str.casefold, names))) == len(names)
    assert not [
        name
        for name in names
        if ".." in name.split("/") or "\\" in name or not name.startswith("rigid-body/")
    ]


def test_every_submission_is_in_the_zip_with_its_report(found):
    assert found("first", "submission.py") == b"x = 1"
    assert found("best", "report-2.json") == b"x = 2"  # its file was called report.json
    assert json.loads(found("best", "report.json"))["score"] == 3 and b"3 of 3 points" in found(
        "best", "report.txt"
    )
    assert found("worse") == {"submission.py", "report.json", "report.txt"}
    assert found("waits") == {"submission.py"}
    assert (found(EVIL, "submission.py"), found(TWIN, "submission.py")) == (b"y = 0", b"y = 1")


def test_grades_roster_and_who_did_what_are_in_the_zip(archive, asked):
    def of(name):
        return archive.read(f"rigid-body/{name}")

    assert lines(of("grades.csv")) == lines(asked(f"{SLUG}/grades.csv")[2])
    assert (
        json.loads(of("grades.json"))["students"] == json.loads(asked(f"{SLUG}/grades.json")[2])["students"]
    )
    roster = {line["name"]: line["role"] for line in lines(of("roster.csv"))}
    assert len(roster) == 9 and roster["tess"] == "assistant" and roster["ada"] == "student"
    (entry,) = [line for line in lines(of("audit/0001.csv")) if line["action"] == "roster"]
    assert (entry["who"], entry["subject"], entry["detail"]) == ("prof", "'=1", '{"people": 7}')
    assert [line["reason"] for line in lines(of("overrides.csv"))][:2] == ["'=1+1 is right", "of no effect"]
