"""The checks of counted submissions, as PostgreSQL aggregates them."""

from polhode.judging.outcome import Diagnosis
from service.store.course import gradebook, outcomes
from tests.support.database import run, sql
from tests.support.reports import SLIP
from tests.support.submissions import grade, hand_in

RAISED = Diagnosis("raises", "ValueError: no", 1.0)
MARKS = {"2-energy": "✓", "2-momentum": ("✗", 0.5), "2-motion": "⏱", "2-pointwise": "!", "2-secret": "–"}
GIVE = (
    "INSERT INTO override (submission_id, check_id, points, reason, given_by) VALUES (%s, %s, %s, 'because',"
    " 'prof')"
)


def ask(url, query, *values):
    async def read(database):
        return await query(
            database, gradebook.graded(await gradebook.students(database, "rigid-body")), *values
        )

    return run(url, read)


def test_the_states_of_a_student(database_url):
    id = run(database_url, lambda database: hand_in(database, "ann", MARKS))
    (states,) = ask(database_url, outcomes.by_student).values()
    assert states == {
        "2-energy": "pass", "2-momentum": "fail", "2-motion": "timeout", "2-pointwise": "error",
        "2-secret": "unmeasured",
    }  # fmt: skip
    for check, points in (("2-energy", 0), ("2-momentum", 1)):
        sql(database_url, GIVE, id, check, points)
    (states,) = ask(database_url, outcomes.by_student).values()
    assert (states["2-energy"], states["2-momentum"], states["2-motion"]) == ("fail*", "pass*", "timeout")


def test_a_class_by_check(database_url):
    async def fill(database):
        await hand_in(database, "ann", {"2-energy": ("✓", 8.0), "2-momentum": ("✓", None)})
        await hand_in(database, "ben", {"2-energy": ("✗", 0.1, SLIP), "2-momentum": ("✓", None)})
        await hand_in(database, "cleo", {"2-energy": ("✗", 0.2, RAISED)})

    run(database_url, fill)
    found = ask(database_url, outcomes.by_check)
    energy, momentum = found["2-energy"], found["2-momentum"]
    assert sorted(energy.states.split()) == ["fail", "fail", "pass"] and sorted(energy.margins) == [
        0.1,
        0.2,
        8.0,
    ]
    assert sorted(energy.causes) == sorted([SLIP.sentence, RAISED.sentence]) and (
        energy.exact,
        energy.smallest,
    ) == (0, 8.0)
    assert (momentum.states, momentum.margins, momentum.causes) == ("pass pass", None, None)
    assert (momentum.exact, momentum.smallest) == (2, None)


def test_causes_count_students_and_an_override_takes_a_cause_away(database_url):
    async def fill(database):
        await hand_in(
            database,
            "ann",
            {"2-energy": ("✗", 0.1, SLIP), "2-momentum": ("✗", 0.1, SLIP), "2-motion": ("!", 1.0, RAISED)},
        )
        return await hand_in(database, "ben", {"2-energy": ("✗", 0.1, SLIP)})

    ben = run(database_url, fill)
    assert [tuple(row)[:4] for row in ask(database_url, outcomes.by_cause)] == [
        (SLIP.code, SLIP.sentence, 2, 2), (RAISED.code, RAISED.sentence, 1, 1)]  # fmt: skip
    sql(database_url, GIVE, ben, "2-energy", 1)
    assert {row.sentence: row.students for row in ask(database_url, outcomes.by_cause)} == {
        SLIP.sentence: 1,
        RAISED.sentence: 1,
    }


def test_outcomes_match_a_check_a_state_and_a_cause(database_url):
    async def fill(database):
        await hand_in(database, "ann", MARKS)
        await hand_in(database, "ben", {"2-energy": ("✗", 0.1, SLIP), "2-momentum": "✓"})

    run(database_url, fill)

    def found(check=None, state=None, cause=None):
        all_ = ask(database_url, outcomes.matching, check, state, cause).values()
        return sorted((row.check, row.shown, row.cause) for rows in all_ for row in rows)

    assert found("2-energy") == [("2-energy", "fail", SLIP.sentence), ("2-energy", "pass", None)]
    assert [check for check, *_ in found(state="fail")] == ["2-energy", "2-momentum"]
    assert [check for check, *_ in found(cause=SLIP.sentence, state="error")] == ["2-pointwise"]
    assert len(found(cause=SLIP.sentence)) == len(found(state="not-pass")) == 5
    assert [check for check, *_ in found("2-motion", "not-pass")] == ["2-motion"] and found(
        "2-motion", "pass"
    ) == []
    assert found(state="none") == found(cause="' OR true --") == found("no check") == []


def test_what_is_graded_while_a_class_is_read(database_url):
    async def read(database):
        id = await hand_in(database, "ann", None)
        class_ = await gradebook.students(database, "rigid-body")
        await grade(database, id, {"2-energy": "✗"})
        return class_, await outcomes.by_student(database, gradebook.graded(class_))

    (ann,), states = run(database_url, read)
    assert (ann.status, states) == ("queued", {})
    (states,) = ask(database_url, outcomes.by_student).values()
    assert states == {"2-energy": "fail"}
