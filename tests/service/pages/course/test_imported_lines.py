"""The instructors' page of imported notebooks: how many lines count, and what makes the others count."""

import pytest

from service.cli.__main__ import main
from service.store.people import people
from tests.support.assignments import change, known
from tests.support.course_shape import published, written
from tests.support.database import new_database, run


@pytest.fixture(scope="module")
def url(postgres):
    url = new_database(postgres.url, "polhode")

    async def fill(database):
        async with database.begin() as connection:
            await people.enroll(connection, [("prof", "instructor"), ("ann", "student")])

    run(url, fill)
    return url


@pytest.fixture(scope="module", autouse=True)
def imported(tmp_path_factory):
    folder = tmp_path_factory.mktemp("imported")
    always = 'validate.check(np.pi > 3, "π is more than 3")\n'
    file = written(folder, "small-sums.ipynb", published(checks=(always, *published.__defaults__[2][1:])))
    with known():
        assert main(["import-notebook", str(file), "--into", str(folder / "into")]) == 0
    change(folder / "into" / "small_sums" / "assignment.py", "shown=True", "shown=True, accept=True")
    with known(folder / "into"):
        yield


def test_the_numbers_of_lines_stand_beside_each_notebook(looks):
    status, page, _ = looks("prof", "/lines")
    assert status == 200 and "9.9 Small sums</a></th><td>1</td><td></td><td>2</td><td>1</td>" in page
    assert '<a href="/lines">' in looks("prof", "/")[1]


def test_a_notebooks_page_says_of_each_line_whether_it_counts(looks):
    status, page, _ = looks("prof", "/lines?assignment=small-sums")
    assert status == 200 and "polhode verify small-sums" in page
    row = page.partition("the series is near π</th>")[2].partition("</tr>")[0]
    assert "<td>1</td>" in row, "accepted"
    assert "cannot count" in page.partition("π is more than 3</th>")[2].partition("</tr>")[0]
    assert (
        "the comment above the line" in page.partition("the area is positive</th>")[2].partition("</tr>")[0]
    )


def test_students_do_not_see_it_and_an_unknown_assignment_is_named(looks):
    assert looks("ann", "/lines")[0] == 403
    assert "/lines" not in looks("ann", "/")[1]
    assert looks("prof", "/lines?assignment=nothing")[0] == 404
