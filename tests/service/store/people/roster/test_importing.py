"""What the import of a roster changes in a course, and what it asks first."""

import asyncio

import pytest

from service.store.people import people
from service.store.people.roster.importing import carry_out, compare
from service.store.people.roster.reading import read
from tests.support.database import entered, run, sql

COURSE = [
    ("prof", "instructor", "Ida Hu", "hu@x.org"),
    ("tina", "assistant"),
    ("ann", "student", "Ann Lee", "ann@x.org", "7", "A"),
    ("ben", "student"),
    ("gone", "former"),
]


@pytest.fixture
def plan(database_url):
    """The plan of a roster's import into the course above."""

    async def enter(database):
        async with database.begin() as connection:
            await people.enroll(connection, COURSE)

    run(database_url, enter)
    return lambda text, importer=None: run(
        database_url, lambda database: compare(database, read(text.encode(), "r.csv"), importer)
    )


def asked(plan):
    return {question.sentence: [*question.details] for question in plan.questions}


def test_what_is_new_changed_and_absent(plan):
    found = plan("name,full_name,section\nann,Ann Lee,B\nprof,Ida Hu,\nzoe,Zoe Ax,B\n")
    assert [(change.entry.name, change.kind, dict(change.columns)) for change in found.changes] == [
        ("ann", "changed", {"section": ("A", "B")}),
        ("prof", "unchanged", {}),
        ("zoe", "new", {}),
    ]
    assert [found.number(kind) for kind in ("new", "changed", "unchanged")] == [1, 1, 1]
    assert [row.name for row in found.absent] == ["ben"] and not found.questions and not found.errors


def test_a_teacher_never_becomes_a_student(plan, database_url):
    found = plan("name,role\nprof,Student\ntina,Student\ngone,Student\n")
    assert asked(found) == {
        "2 members of the staff are students in the file; they keep their roles.": [
            "prof: instructor in the course, student in the file",
            "tina: assistant in the course, student in the file",
        ]
    }

    async def import_it(database):
        async with database.begin() as connection:
            assert await carry_out(connection, found, "boss", None) == []

    run(database_url, import_it)
    roles = "SELECT p.name, role FROM member JOIN person p ON p.id = person_id WHERE p.name = ANY(%s)"
    assert sorted(sql(database_url, roles, ["prof", "tina", "gone"])) == [
        ("gone", "student"),
        ("prof", "instructor"),
        ("tina", "assistant"),
    ]
    assert sql(database_url, "SELECT subject, detail FROM audit WHERE action = 'roster'") == [
        ("r.csv", {"people": 3, "tokens": 0})
    ]


def test_nobody_removes_their_own_role(plan):
    text = "name,role\nprof,assistant\n"
    own = "this roster would remove your own instructor role: correct your line"
    assert own in plan(text, "prof").errors and own not in plan(text, "boss").errors


def test_an_instructor_remains(plan):
    text = "name,role\nprof,assistant\n"
    (error,) = plan(text).errors
    assert error == "this roster would leave the course without an instructor: correct a role"
    assert not plan(f"{text}boss,instructor\n").errors


@pytest.mark.parametrize(
    ("line", "shared"),
    [
        ("ann@x.org,Ann Lee,,", "ann@x.org (new) and ann share ann@x.org"),
        ("ANN,Ann Lee,,", "ANN (new) and ann share ANN"),
        ("alee,Ann Lee,Ann@X.org,", "alee (new) and ann share Ann@X.org"),
        ("alee,Ann Lee,,7", "alee (new) and ann share 7"),
    ],
)
def test_a_new_login_of_somebody_who_is_there_is_asked_about(plan, line, shared):
    found = plan(f"login,full_name,email,student_id\n{line}\n")
    assert asked(found) == {"1 person seems to be in the course under another login name.": [shared]}
    (question,) = found.questions
    assert found.open_questions([]) == [question] and found.open_questions([question.key]) == []


def test_an_import_keeps_what_the_file_leaves_out_and_gives_tokens(plan, database_url):
    found = plan("name,full_name,email\nann,,new@x.org\nzoe,Zoe Ax,\n")

    async def import_it(database):
        async with database.begin() as connection:
            return await carry_out(connection, found, "boss", 1000.0)

    assert [name for name, _ in run(database_url, import_it)] == ["ann", "zoe"]
    about = "SELECT full_name, email, student_id, section FROM person WHERE name = 'ann'"
    assert sql(database_url, about) == [("Ann Lee", "new@x.org", "7", "A")]


def test_two_rosters_at_once_leave_an_instructor(database_url):
    for name in ("prof", "emmy"):
        entered(database_url, name, "instructor")

    async def imported(database, name):
        async with database.begin() as connection:
            await people.lock_members(connection)
            found = await compare(connection, read(f"name,role\n{name},assistant\n".encode(), "r.csv"), None)
            await asyncio.sleep(0.1)  # without the lock both have compared by then
            if not found.errors:
                await carry_out(connection, found, "boss", None)
            return len(found.errors)

    async def both(database):
        return await asyncio.gather(*(imported(database, name) for name in ("prof", "emmy")))

    assert sorted(run(database_url, both)) == [0, 1]
