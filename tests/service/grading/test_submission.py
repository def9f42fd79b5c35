import json

import pytest

from service.grading.submission import KIB, BadSubmission, Submission


def notebook(*sources, **fields):
    cells = [{"cell_type": "code", "source": s} for s in sources]
    return json.dumps({"cells": cells, "nbformat": 4} | fields).encode()


def test_a_file_is_one_cell():
    (cell,) = Submission.from_bytes(b"\xef\xbb\xbfx = 1\n", "mine.py").cells()
    assert (cell.name, cell.source) == ("mine.py", "x = 1\n")


@pytest.mark.parametrize("name", ["plays.py", 'a"b.py', "mine.txt", f"{'x' * 90}.py"])
def test_a_name_that_is_not_plain_does_not_stand_in_tracebacks(name):
    assert Submission.from_bytes(b"x = 1\n", name).cells()[0].name == "submission.py"


def test_a_notebook_is_its_code_cells_numbered_as_shown():
    submission = Submission.from_bytes(notebook("x = 1", ["y = 2\n", "z = 3"]), "mine.ipynb")
    assert [(c.name, c.source) for c in submission.cells()] == [
        ("cell 1", "x = 1"),
        ("cell 2", "y = 2\nz = 3"),
    ]


def test_a_notebook_by_a_name_in_large_letters():
    assert Submission.from_bytes(notebook("x = 1"), "MINE.IPYNB").cells()[0].name == "cell 1"


@pytest.mark.parametrize("name", ["mine.py", "MINE.PY", "mine", "mine.ipynb.json"])
def test_a_notebook_by_another_name(name):
    data = notebook("x = 1", outputs=[], metadata={"kernelspec": {"name": "python3"}})
    submission = Submission.from_bytes(b"\n" + data, name)
    assert [cell.name for cell in submission.cells()] == ["cell 1"] and submission.filename == name
    assert "outputs" not in json.loads(submission.source)


@pytest.mark.parametrize(
    "source", ['{"cells": 3}', "{'cells': []}", '{"worksheets": []}', "{x: 1}", "[1, 2]"]
)
def test_python_that_looks_like_a_notebook(source):
    (cell,) = Submission.from_bytes(source.encode(), "mine.py").cells()
    assert (cell.name, cell.source) == ("mine.py", source)


def test_python_by_the_name_of_a_notebook_says_what_to_do():
    with pytest.raises(BadSubmission, match=r"save it in Jupyter, or, if it is Python, name it \.py$"):
        Submission.from_bytes(b"x = 1", "Mine.Ipynb")


def test_a_path_in_a_file_name_is_dropped():
    assert Submission.from_bytes(b"x = 1", "../../etc/cron.d/mine.py").filename == "mine.py"


@pytest.mark.parametrize(
    ("data", "name", "why"),
    [
        (b"x" * (256 * KIB + 1), "a.py", "it has 257 KiB and at most 256 KiB are accepted; remove data"),
        (notebook("x" * 300 * KIB), "a.ipynb", "without outputs it has 301 KiB and at most 256 KiB"),
        (b" " * (20 * 1024 * KIB + 1), "a.ipynb", "larger than 20 MiB: clear the outputs of the notebook"),
        (b'{"cells": [' + b"[" * 300 * KIB, "a.ipynb", "not a Jupyter notebook"),
        (b"\x89PNG\r\n\x1a\n", "a.py", "not a text file"),
        (b"x = 1\x00", "a.py", "zero bytes"),
        (b"   \n", "a.py", "no code"),
        (b"x = 1", "a.ipynb", "not a Jupyter notebook"),
        (b"[" * 100_000, "a.ipynb", "not a Jupyter notebook"),
        (b'{"cells": 3}', "a.ipynb", "not a Jupyter notebook"),
        (b'{"cells": [{"cell_type": "code", "source": 3}]}', "a.ipynb", "not a Jupyter notebook"),
        (b'{"worksheets": []}', "a.ipynb", "not a Jupyter notebook"),
        (notebook(), "a.ipynb", "no code"),
    ],
)
def test_what_is_no_submission_says_why(data, name, why):
    with pytest.raises(BadSubmission, match=why):
        Submission.from_bytes(data, name)
