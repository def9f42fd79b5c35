"""The published cells take the place of their copies, and finding these takes the host little time."""

import random
import time

import pytest

from exercises.authoring.assignments.assignment import PublishedCell
from exercises.authoring.publishing.publish import BROUGHT
from service.grading.grade import grade
from service.grading.published.given_cells import with_published
from service.grading.submission import Submission
from service.sandbox.job import Cell
from tests.support.course_notebook import code

MOST_S = 2.0  # of the host's CPU time, for the largest submission that is accepted
KIB = 1 << 10


@pytest.fixture(scope="module")
def published():
    """Those of a course's notebook, several times, as a long one has them: 60 cells."""
    cells = code().items()
    return [
        PublishedCell(
            f"published cell {k} {id}", f"# {k}\n{source}", "validate" in source, "", "validate" in source
        )
        for k in range(4)
        for id, source in cells
    ]


def shuffled(published, cells, characters):
    """Cells of the words of the published ones in random order."""
    rng, words = random.Random(1), " ".join(cell.source for cell in published).split(" ")
    found = []
    for k in range(cells):
        text = ""
        while len(text) < characters / cells:
            text += rng.choice(words) + " "
        found.append(Cell(f"cell {k}", text))
    return found


HOSTILE = {
    "shuffled cells": lambda given: shuffled(given, 490, 231 * KIB),
    "long shuffled cells": lambda given: shuffled(given, 20, 231 * KIB),
    "one cell of copies": lambda given: [
        Cell("submission.py", "\n".join(cell.source for cell in given * 40)[: 250 * KIB])
    ],
    "one line again and again": lambda given: [
        Cell("submission.py", f"{given[-1].source.splitlines()[0]}\n" * 2500)
    ],
    "short lines": lambda given: [Cell(f"cell {k}", "x\n" * 250) for k in range(500)],
    "empty lines": lambda given: [Cell("submission.py", "\n" * 250 * KIB)],
    "marks": lambda given: [Cell("submission.py", "# %%\n" * 490 + "x\n" * 120 * KIB)],
    "marks in many cells": lambda given: [Cell(f"cell {k}", "# %%\nx\n" * 60) for k in range(500)],
    "copies of one cell": lambda given: [Cell(f"cell {k}", given[-1].source) for k in range(490)],
}


@pytest.mark.parametrize("name", HOSTILE)
def test_finding_copies_takes_little_time_and_no_more_room_than_the_submission(published, name):
    cells = HOSTILE[name](published)
    began = time.thread_time()
    merged = with_published(cells, published)
    assert time.thread_time() - began < MOST_S
    assert sum(len(cell.source) for cell in merged) < 2000 * KIB
    assert [cell.name for cell in merged if cell.published] == [one.name for one in published if one.is_given]


def test_what_the_host_computes_is_charged(rigid_body, sandbox, monkeypatch):
    from service.grading import grade as grading

    def slow(*asked):
        until = time.thread_time() + 0.5
        while time.thread_time() < until:
            pass
        return job_of(*asked)

    job_of = grading.job_of
    monkeypatch.setattr(grading, "job_of", slow)
    graded = grade(Submission("def euler_eqs(t, w, I):\n    return w\n"), rigid_body, sandbox, 1, ["2"])
    assert graded.cpu_s > 0.5


GIVEN = (
    PublishedCell("setup", "import numpy as np\nN = 10\n", True, ""),
    PublishedCell("solution", "# yours\n", False, ""),
    PublishedCell("validation", 'validate.close(x, 1.0, "x is one", rtol=1e-6)', True, "", True),
    PublishedCell("other solution", "# yours\n", False, ""),
    PublishedCell("more", 'validate.close(x, 2.0, "x is two", rtol=1e-6)', True, "", True),
)


@pytest.mark.parametrize(
    "edited",
    [
        'validate.close(x, 1.0, "x is One", rtol=1e-6)',
        'validate.close(x, 1.0, "x is one", rtol=1e-3)',
        'validate.close( x,1.0,"x is one",rtol = 1e-6 )',
        'print(x)\nvalidate.close(x, 1.0, "x is one", rtol=1e-6)  # mine',
        'validate.close(x[0], 1.0, "x is one", rtol=1e-6)',
    ],
)
def test_an_edited_copy_stands_where_the_student_has_it(edited):
    sources = [GIVEN[0].source, "x = 1.0", edited, "x = 2.0", GIVEN[4].source]
    merged = with_published([Cell(f"cell {k}", text) for k, text in enumerate(sources, 1)], GIVEN)
    names = [cell.name for cell in merged]
    assert names == ["setup", "cell 2", "cell 3", "validation", "cell 4", "more"]


def test_a_copy_with_the_comment_of_the_students_notebook_is_not_edited():
    setup = PublishedCell("setup", "import numpy as np\nimport ecp\nN = 10\n", True, "")
    commented = setup.source.replace("import ecp", "import ecp" + BROUGHT.format(package="ecp"))
    for source, names in ((commented, ["setup"]), (commented + "# mine", ["setup", "cell 1"])):
        assert [cell.name for cell in with_published([Cell("cell 1", source)], [setup])] == names


def test_a_cell_of_the_student_is_no_copy_because_it_uses_the_same_names():
    sources = [
        GIVEN[0].source,
        "x = 1.0",
        'plt.plot(x, label="x is one")',
        GIVEN[2].source,
        "x = 2.0",
        GIVEN[4].source,
    ]
    merged = with_published([Cell(f"cell {k}", text) for k, text in enumerate(sources, 1)], GIVEN)
    assert [cell.name for cell in merged] == ["setup", "cell 2", "cell 3", "validation", "cell 5", "more"]


def test_lines_keep_their_numbers():
    text = f"x = 1.0\n{GIVEN[2].source}\nx = 2.0\ny = 3.0\n{GIVEN[4].source}"
    merged = with_published([Cell("submission.py", text)], GIVEN)
    assert [cell.source for cell in merged if cell.name == "submission.py"] == [
        "x = 1.0",
        "\n\nx = 2.0\ny = 3.0",
    ]
