"""Settings of the course on their pages, and what they change: times, points of late submissions, the total,
notes.
"""

import csv
import io
import json
import re
from datetime import UTC, datetime, timedelta

import pytest

from service.store.course import deadlines
from service.store.people import people
from tests.support.database import entered, new_database, run, sql
from tests.support.http_client import call
from tests.support.submissions import hand_in

OWN = "/assignments/rigid-body"
SETTINGS = f"{OWN}/class/settings"
DUE = datetime(2026, 3, 1, 12, tzinfo=UTC)
PASSED = {"2-energy": "✓", "2-momentum": "✓"}


@pytest.fixture(scope="module")
def url(postgres):
    """Ann is late by 25 hours, and has a better and a worse submission in time; ben is late by an hour but
    has an extension.
    """
    url = new_database(postgres.url, "polhode")

    async def fill(database):
        async with database.begin() as connection:
            await people.enroll(
                connection, [("prof", "instructor"), ("helper", "assistant"), ("cleo", "student")]
            )
        sent = {
            "late": await hand_in(database, "ann", PASSED),
            "extended": await hand_in(database, "ben", PASSED),
        }
        return sent | {"waits": await hand_in(database, "cleo", None)}

    sent = run(url, fill)
    sql(url, "ALTER TABLE submission DISABLE TRIGGER USER")  # as if the submissions had come at another time
    sql(url, "UPDATE assignment SET due_at = %s, grace_s = 1e6 WHERE slug = 'rigid-body'", DUE)
    for name, late in (
        ("late", timedelta(hours=25)),
        ("extended", timedelta(hours=1)),
        ("waits", timedelta(hours=1)),
    ):
        sql(url, "UPDATE submission SET submitted_at = %s, late = true WHERE id = %s", DUE + late, sent[name])
    assert run(
        url,
        lambda d: deadlines.extend(d, "rigid-body", "ben", DUE + timedelta(days=1), reason="ill", by="prof"),
    )
    return url


@pytest.fixture
def save(looks):
    """Save the settings of the course; fields that are not given have their defaults."""

    def send(**fields):
        return looks(
            "prof", "/settings", at="/settings", **{"time_zone": "UTC", "late_penalty": "0"} | fields
        )

    yield send
    assert send()[0] == 200


def exported(looks, form):
    text = looks("prof", f"{OWN}/{form}")[1]
    return list(csv.DictReader(io.StringIO(text.removeprefix("\ufeff"), newline="")))


def test_a_late_penalty_reaches_every_export_the_api_and_the_pages(server, url, looks, save):
    """Two days have begun: 2 × 15 % of 2 points, at most 25 %."""
    assert "for each day late" not in looks("ann", OWN)[1]
    for limit, penalty, final in (("100", 0.6, 1.4), ("25", 0.5, 1.5)):
        assert save(late_penalty="15", late_penalty_limit=limit)[0] == 200
        assert "grace, minus 15 % of the points for each day late" in looks("ann", OWN)[1]
        own, numbers = exported(looks, "grades.csv"), (str(penalty), str(final))
        assert [(line["points"], line["penalty"], line["final"]) for line in own[:2]] == [
            ("2", *numbers),
            ("2", "0", "2"),
        ]
        assert own[0]["percent"] == f"{round(100 * final / 36, 2)}"
        told = json.loads(looks("prof", f"{OWN}/grades.json")[1])["students"]
        assert [(one["points"], one["penalty"], one["final"]) for one in told] == [
            (2, penalty, final),
            (2, 0, 2),
            (None, 0, None),
        ]
        lines = {line["student_id"]: line for line in exported(looks, "grades/nbgrader.csv")}
        nbgrader = [lines["ann"][name] for name in ("raw_score", "late_submission_penalty", "score")]
        assert nbgrader == ["2.0", *numbers] and lines["ben"]["late_submission_penalty"] == "0.0"
        assert {line["SIS Login ID"]: [*line.values()][-1] for line in exported(looks, "grades/canvas.csv")}[
            "ann"
        ] == str(final)
        assert {line["Username"]: [*line.values()][-1] for line in exported(looks, "grades/moodle.csv")}[
            "ann"
        ] == str(final)
        gradescope = {line["Email"]: line for line in exported(looks, "grades/gradescope.csv")}
        assert (gradescope["ann"]["Total Score"], gradescope["ann"]["Lateness (H:M:S)"]) == (
            str(final),
            "25:00:00",
        )
        assert (gradescope["ben"]["Total Score"], gradescope["ben"]["Lateness (H:M:S)"]) == ("2", "00:00:00")
        course = list(
            csv.DictReader(io.StringIO(looks("prof", "/grades.csv")[1].removeprefix("\ufeff"), newline=""))
        )
        assert course[0]["rigid-body final"] == str(final) and course[0]["rigid-body points"] == "2"
        ann = {"Authorization": f"Bearer {entered(url, 'ann', None)}"}
        (listed,) = json.loads(call(server, "/v1/assignments/rigid-body/submissions", **ann)[2])[
            "submissions"
        ]
        assert (listed["points"], listed["penalty"], listed["final"]) == (2, penalty, final)
        one = json.loads(call(server, f"/v1/submissions/{listed['id']}", **ann)[2])
        assert (one["penalty"], one["final"], one["report"]["score"]) == (penalty, final, 2)
        assert (
            f"<b>{final} of 36 points</b> after a late penalty of {penalty}"
            in looks("ann", f"/submissions/{listed['id']}")[1]
        )
        assert f">{final}</a> late" in looks("prof", f"{OWN}/class/students")[1]
        assert f">{final}</a> of 36 + 6 bonus, late (−{penalty})" in looks("prof", "/person?name=ann")[1]
        median = (final + 2) / 2
        assert f"median {median:g} of 36 points" in looks("prof", "/")[1]
        overview = looks("prof", f"{OWN}/class")[1]
        assert (
            f"<b>{median:g}</b> median of 36" in overview
            and f"median {median:g} of 36, from {final} to 2" in overview
        )
        assert (
            f'<td class="one-line">{final} of 36 + 6 bonus</td>'
            in looks("prof", f"{OWN}/class/submissions")[1]
        )
        ordered = [looks("prof", f"{OWN}/class/students?sort={by}")[1] for by in ("points", "worst")]
        assert ordered[0].index("/person?name=ben") < ordered[0].index("/person?name=ann")
        assert ordered[1].index("/person?name=ann") < ordered[1].index("/person?name=ben")


def test_the_submission_with_the_most_points_after_the_penalty_counts(url, looks, save):
    sql(url, "UPDATE assignment SET due_at = NULL")
    earlier = run(url, lambda d: hand_in(d, "ann", {"2-energy": "✓", "2-momentum": "✗"}))
    sql(url, "UPDATE assignment SET due_at = %s WHERE slug = 'rigid-body'", DUE)
    sql(
        url,
        "UPDATE submission SET submitted_at = %s, late = false WHERE id = %s",
        DUE - timedelta(days=1),
        earlier,
    )
    try:
        for penalty, final in (("0", "2"), ("20", "1.2"), ("40", "1")):
            save(late_penalty=penalty)
            ann = exported(looks, "grades.csv")[0]
            assert ann["final"] == final and (ann["submission"] == str(earlier)) == (penalty == "40")
    finally:
        sql(
            url,
            "UPDATE submission SET person_id = (SELECT id FROM person WHERE name = 'prof') WHERE id = %s",
            earlier,
        )


def test_weights_make_the_total(looks, save):
    """Of the graded assignments on the course page, of all in the export."""
    save(**{"weight-rigid-body": "3", "weight-waves": "1"})
    others = len(re.findall(r'name="weight-', looks("prof", "/settings")[1])) - 1
    assert f"Your total so far: <b>{100 * 2 / 36:.2f} %" in looks("ann", "/")[1]
    assert "Your total" not in looks("cleo", "/")[1] and "Your total" not in looks("prof", "/")[1]
    text = looks("prof", "/grades.csv")[1].removeprefix("\ufeff")
    ann = next(csv.DictReader(io.StringIO(text, newline="")))
    assert float(ann["total_percent"]) == pytest.approx(3 * 100 * 2 / 36 / (3 + others), abs=0.01)
    save(**{"weight-rigid-body": "1"})


def test_times_are_shown_and_read_in_the_time_zone_of_the_course(url, looks, save):
    assert save(time_zone="Europe/Berlin")[0] == 200
    page = looks("prof", SETTINGS)[1]
    assert 'value="2026-03-01T13:00"' in page and "Deadline (Europe/Berlin)" in page
    assert '<time datetime="2026-03-01T12:00:00+00:00">2026-03-01 13:00</time>' in looks("ann", OWN)[1]
    assert (
        looks(
            "prof", f"{OWN}/rules", at=SETTINGS, due="2026-07-01T13:00", grace="16666", most="", past="yes"
        )[0]
        == 200
    )
    assert sql(url, "SELECT due_at FROM assignment WHERE slug = 'rigid-body'") == [
        (datetime(2026, 7, 1, 11, tzinfo=UTC),)
    ]
    sql(url, "UPDATE assignment SET due_at = %s, grace_s = 0 WHERE slug = 'rigid-body'", DUE)
    refused = looks(
        "ann",
        f"{OWN}/submissions",
        at=OWN,
        files={"file": ("a.py", b"def euler_eqs(t, w, I):\n    return w\n")},
    )
    assert (
        refused[0] == 403
        and "the deadline was 2026-03-01 13:00 Europe/Berlin: ask the course staff" in refused[1]
    )
    sql(url, "UPDATE assignment SET due_at = %s, grace_s = 1e6 WHERE slug = 'rigid-body'", DUE)


@pytest.mark.parametrize(
    ("fields", "pointer"),
    [
        ({"time_zone": "Mars/Olympus"}, "/time_zone"),
        ({"time_zone": "../etc/passwd"}, "/time_zone"),
        ({"late_penalty": "101"}, "/late_penalty"),
        ({"late_penalty": "nan"}, "/late_penalty"),
        ({"late_penalty_limit": "-1"}, "/late_penalty_limit"),
        ({"weight-rigid-body": "x"}, "/weight-rigid-body"),
    ],
)
def test_wrong_settings_are_refused_at_their_field(server, looks, url, save, fields, pointer):
    before = sql(url, "SELECT * FROM course"), sql(url, "SELECT slug, weight FROM assignment ORDER BY slug")
    status, page, _ = save(**fields)
    assert status == 422 and 'role="alert"' in page
    assert (
        sql(url, "SELECT * FROM course"),
        sql(url, "SELECT slug, weight FROM assignment ORDER BY slug"),
    ) == before
    assert pointer[1:] in fields


def test_the_release_is_set_on_the_page(url, looks):
    modes = (
        "SELECT scores_release, details_release, scores_released_at IS NOT NULL FROM assignment WHERE slug ="
        " 'rigid-body'"
    )
    assert looks("prof", f"{OWN}/release", at=SETTINGS, scores="manually", details="deadline")[0] == 200
    assert sql(url, modes) == [("manually", "deadline", False)]
    page = looks("prof", SETTINGS)[1]
    assert "Release scores now" in page and "Release details now" not in page
    assert (
        "<dd>not released yet</dd>" in looks("ann", OWN)[1] and "scores not released" in looks("ann", "/")[1]
    )
    assert "<dd>none yet</dd>" in looks("cleo", OWN)[1] and "scores not released" not in looks("cleo", "/")[1]
    assert looks("prof", f"{OWN}/release", at=SETTINGS, action="release scores")[0] == 200
    assert (
        sql(url, modes) == [("manually", "deadline", True)]
        and "Withdraw the release of scores" in looks("prof", SETTINGS)[1]
    )
    assert looks("prof", f"{OWN}/release", at=SETTINGS, action="withhold scores")[0] == 200
    assert sql(url, modes)[0][2] is False and "Your total" not in looks("ann", "/")[1]
    assert looks("prof", f"{OWN}/release", at=SETTINGS, scores="never", details="deadline")[0] == 422
    assert looks("prof", f"{OWN}/release", at=SETTINGS, scores="immediately", details="immediately")[0] == 200


def test_notes_on_a_student_are_for_the_staff(url, looks):
    person = "/person?name=ann"
    assert looks("helper", "/person/notes?name=ann", at=person, note="was ill <b>")[0] == 200
    page = looks("prof", person)[1]
    assert "was ill &lt;b&gt;" in page and "helper, " in page
    assert all("was ill" not in looks("ann", path)[1] for path in ("/", OWN, "/account"))
    (id,) = re.findall(r'name="remove" value="([0-9a-f-]+)"', page)
    assert looks("helper", "/person/notes?name=ann", at=person, note=" ")[0] == 422
    assert looks("helper", "/person/notes?name=cleo", at=person, remove=id)[0] == 404
    assert looks("helper", "/person/notes?name=ann", at=person, remove=id)[0] == 200
    assert "was ill" not in looks("prof", person)[1] and sql(url, "SELECT count(*) FROM note") == [(0,)]
    assert looks("ann", "/person/notes?name=ann", at="/", note="x")[0] == 403
