"""What prune deletes can be made again; submissions, reports and scores stay."""

import uuid

import pytest

from exercises.authoring.assignments.catalogue import assignments
from service.cli.__main__ import main
from service.store.course import regrades
from service.store.postgres import backup, retention
from service.store.queue import runs
from service.store.queue.overview import regrade
from service.store.submissions.artefacts import find_artefact, store_artefacts
from tests.support.database import run, sql
from tests.support.reports import report_of_marks
from tests.support.submissions import hand_in

DRAWN, ARRAYS = (
    {"figures/omega.svg": b"<svg/>", "motions/free.json": b"{}"},
    {"arrays.npz": b"numbers of the regrade"},
)
KEPT = ("submission", "grading", "result", "outcome", "run", "person")


def files(url):
    return {
        (str(grading), name) for grading, name in sql(url, "SELECT grading_id, name FROM grading_artefact")
    }


def rows(url):
    return {table: sorted(sql(url, f"SELECT t::text FROM {table} t")) for table in KEPT}


def grading_of(url, submission, number=1):
    return sql(url, "SELECT id FROM grading WHERE submission_id = %s AND number = %s", submission, number)[0][
        0
    ]


def pruned(url, *, days=0, arrays=False, delete=True, versions=None):
    versions = versions or {slug: one.version for slug, one in assignments().items()}
    found = retention.prune(url, versions, days=days, arrays=arrays, delete=delete)
    return {one.kind: one.files for one in found}


@pytest.fixture
def submission(database_url):
    """A graded submission whose figure and motion were drawn."""

    async def store(database):
        id = await hand_in(database, "ann", {"2-energy": "✓"}, version=assignments()["rigid-body"].version)
        await store_artefacts(database, (await database.rows(NEWEST, {"id": id}))[0].id, DRAWN)
        return id

    return run(database_url, store)


def again(url, submission):
    """Grade a submission again."""

    async def grade(database):
        await regrade(database, [submission], "prof")
        one = await runs.claim(
            database, (await database.rows(NEWEST, {"id": submission}))[0].id, uuid.uuid4(), "test worker"
        )
        assert await runs.finish(database, one, report_of_marks({"2-energy": "✗"}), ARRAYS)

    run(url, grade)


NEWEST = "SELECT id FROM grading WHERE submission_id = %(id)s ORDER BY number DESC LIMIT 1"


def test_counting_deletes_nothing(database_url, submission):
    before = files(database_url), rows(database_url)
    assert pruned(database_url, delete=False) == {"replaced": 0, "drawn": 2}
    assert (files(database_url), rows(database_url)) == before


def test_drawn_figures_go_and_the_arrays_to_draw_them_from_stay(database_url, submission):
    kept, grading = rows(database_url), str(grading_of(database_url, submission))
    assert pruned(database_url, days=1) == {"replaced": 0, "drawn": 0}  # too new
    assert pruned(database_url) == {"replaced": 0, "drawn": 2}
    assert files(database_url) == {(grading, "arrays.npz")} and rows(database_url) == kept
    assert sql(database_url, "SELECT content FROM artefact") == [(b"none",)]


def test_a_figure_of_a_former_version_of_the_assignment_stays(database_url, submission):
    assert pruned(database_url, versions={"rigid-body": "later"})["drawn"] == 0


def test_the_arrays_go_only_if_asked_and_figures_that_need_them_stay(database_url, submission):
    kept, grading = rows(database_url), str(grading_of(database_url, submission))
    assert pruned(database_url, arrays=True) == {"replaced": 0, "arrays": 1}
    assert (
        files(database_url) == {(grading, name) for name in (*DRAWN, "pruned")} and rows(database_url) == kept
    )
    assert pruned(database_url) == {"replaced": 0, "drawn": 0}
    assert not any(backup.check(database_url).values())
    again(database_url, submission)
    assert files(database_url) >= {(str(grading_of(database_url, submission, 2)), "arrays.npz")}


def test_files_of_a_replaced_grading_go_and_those_of_an_undecided_preview_stay(database_url, submission):
    again(database_url, submission)
    assert pruned(database_url) == {"replaced": 3, "drawn": 0}
    assert files(database_url) == {
        (str(grading_of(database_url, submission)), "pruned"),
        (str(grading_of(database_url, submission, 2)), "arrays.npz"),
    }
    assert not any(backup.check(database_url).values())


@pytest.mark.parametrize("decision", [None, "drop", "apply"])
def test_a_preview_keeps_its_files_until_its_regrade_is_decided(database_url, submission, decision):
    async def preview(database):
        id = await regrades.create(database, "rigid-body", submission, "prof", description="one")
        one = await runs.claim(
            database, (await database.rows(NEWEST, {"id": submission}))[0].id, uuid.uuid4(), "test worker"
        )
        assert await runs.finish(database, one, report_of_marks({"2-energy": "✗"}), ARRAYS)
        if decision:
            await getattr(regrades, decision)(database, id, "prof")

    run(database_url, preview)
    first, second = (str(grading_of(database_url, submission, k)) for k in (1, 2))
    pruned(database_url)
    holding = {None: {first, second}, "drop": {first}, "apply": {second}}[decision]
    assert {grading for grading, name in files(database_url) if name == "arrays.npz"} == holding


def test_contents_that_another_grading_shares_stay(database_url, submission):
    async def share(database):
        other = await hand_in(database, "ben", {"2-energy": "✓"}, version="former")
        await store_artefacts(
            database, (await database.rows(NEWEST, {"id": other}))[0].id, {"figures/omega.svg": b"<svg/>"}
        )
        return other

    other = run(database_url, share)
    assert pruned(database_url)["drawn"] == 2
    found = run(
        database_url, lambda d: find_artefact(d, grading_of(database_url, other), "figures/omega.svg")
    )
    assert found is not None and found[0] == b"<svg/>"


def test_the_command_deletes_only_if_told(database_url, submission, monkeypatch, capsys):
    monkeypatch.setenv("POLHODE_DATABASE_URL", database_url)
    assert main(["db", "prune", "--older-than", "0"]) == 0
    assert "2 files" in (out := capsys.readouterr().out) and "nothing was deleted" in out
    assert len(files(database_url)) == 3
    assert main(["db", "prune", "--older-than", "0", "--delete"]) == 0 and len(files(database_url)) == 1
    assert main(["db", "prune", "--delete"]) == 0 and len(files(database_url)) == 1
    for wrong in ("-1", "nan", "soon"):
        with pytest.raises(SystemExit):
            main(["db", "prune", "--older-than", wrong])
