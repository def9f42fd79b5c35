"""polhode import-notebook: from a published notebook, or a folder of them, to assignments that are served."""

import json

from exercises.authoring.questions.author_notebook import SOLUTION
from service.cli.__main__ import main
from tests.support.assignments import known
from tests.support.course_shape import notebook, published, written


def test_a_course_is_imported_and_each_notebook_says_what_was_taken_over(tmp_path, capsys):
    course = tmp_path / "course"
    written(course / "1-sums", "small-sums.ipynb", published())
    in_function = (
        'def check_all():\n    validate.check(True, "inside")\nvalidate.check(x > 1, label)\n'
        "validate.check(x > 0)\n"
    )
    cells = [
        ("markdown", "t", [], "# Odd things"),
        (
            "code",
            "s",
            [],
            "import sympy\nfrom ecp import validate\nimport no_such_package\n",
        ),
        ("code", "a", [SOLUTION], "x = 2\n"),
        ("code", "v", ["validation"], in_function),
    ]
    written(course / "2 odd", "2.2 Odd ones.ipynb", notebook(*cells))
    written(course / ".ipynb_checkpoints", "small-sums.ipynb", published())
    written(course, "empty.ipynb", notebook(("code", "a", [], "x = 1")))
    with known(tmp_path / "into"):
        assert main(["import-notebook", str(course), "--into", str(tmp_path / "into")]) == 2
    printed = capsys.readouterr()
    assert (
        f"{tmp_path / 'into' / 'small_sums'}: 5 of 5 lines: 2 value shown, 3 self-reported\n  ran in "
        in printed.out
    )
    assert "notebook_2_2_odd_ones: 1 of 3 lines: 1 self-reported" in printed.out
    assert "not taken over: published cell 3, line 2: the call is inside a function" in printed.out
    assert "published cell 1 fails: ModuleNotFoundError: No module named 'no_such_package'" in printed.out
    table = (tmp_path / "into" / "notebook_2_2_odd_ones" / "dry-run.txt").read_text()
    assert "published cell 1" in table and "no_such_package" in table
    assert "not taken over: published cell 3, line 4: the call has no label" in printed.out
    assert "no_such_package is not installed on this machine" in printed.out
    assert "empty.ipynb has no cell that calls validate.close" in printed.err
    text = (tmp_path / "into" / "notebook_2_2_odd_ones" / "assignment.py").read_text()
    assert 'packages=("sympy",)' in text and 'line("{label}")' in text
    with known(tmp_path / "into") as found:
        assert (
            sorted(found.valid) == ["notebook-2-2-odd-ones", "rigid-body", "small-sums"] and not found.invalid
        )
        students = found.valid["small-sums"].notebook()
    assert "polhode.submit()" in students and "polhode.check(" not in students


def test_what_cannot_be_imported_is_named_and_nothing_is_left(tmp_path, capsys):
    text = written(tmp_path, "broken.ipynb", "{").parent
    assert main(["import-notebook", str(tmp_path / "broken.ipynb"), "--into", str(tmp_path / "into")]) == 2
    assert "broken.ipynb is not a Jupyter notebook" in capsys.readouterr().err
    assert main(["import-notebook", str(tmp_path / "nowhere.ipynb"), "--into", str(tmp_path / "into")]) == 2
    assert "nowhere.ipynb is missing" in capsys.readouterr().err
    assert not (text / "into").exists()
    written(tmp_path, "sums.ipynb", published())
    with known():
        assert main(["import-notebook", str(tmp_path / "sums.ipynb"), "--into", str(tmp_path / "into")]) == 0
        assert main(["import-notebook", str(tmp_path / "sums.ipynb"), "--into", str(tmp_path / "into")]) == 2
    assert "is taken by an assignment" in capsys.readouterr().err


def test_data_files_come_along_and_other_names_of_validate_are_named(tmp_path, capsys):
    setup = (
        "import numpy as np\nfrom ecp import validate\n"
        "from ecp import validate as v\nd = np.loadtxt('d.csv')\ne = 'absent.csv'\n"
    )
    file = written(
        tmp_path,
        "data.ipynb",
        notebook(("code", "s", [], setup), ("code", "c", [], 'validate.positive(d, "d > 0")')),
    )
    written(tmp_path, "d.csv", "1 2 3")
    with known():
        assert main(["import-notebook", str(file), "--into", str(tmp_path / "into")]) == 0
    printed = capsys.readouterr().out
    assert (
        "absent.csv is not beside the notebook" in printed
        and "calls validate v: calls under that name" in printed
    )
    assert "no cell is tagged solution" in printed
    assert (tmp_path / "into" / "data" / "d.csv").read_text() == "1 2 3"
    assert 'data=("d.csv",),' in (tmp_path / "into" / "data" / "assignment.py").read_text()


def test_what_the_course_lacks_is_named_once_with_the_notebooks_that_need_it(tmp_path, capsys):
    lab = written(tmp_path / "lab", "__init__.py", "import sympy\nimport no_such_package\n").parent
    written(tmp_path, "requirements.txt", "numpy\nno-such-package>=2\n-e .\n")
    setup = notebook(("code", "s", [], "import lab"), ("code", "c", ["solution"], 'validate.check(x, "a")'))
    for name in ("one", "two"):
        written(tmp_path / "in", f"{name}.ipynb", setup.replace("solution", "validation"))
    command = ["import-notebook", str(tmp_path / "in"), "--into", str(tmp_path / "into")]
    with known():
        assert main([*command, "--package", str(lab)]) == 0
    printed = capsys.readouterr().out
    assert printed.count("no_such_package is not installed") == 1
    assert (
        "no_such_package is not installed on this machine (the course's requirements.txt: no-such-package>=2)"
        "; one.ipynb, two.ipynb cannot run without it"
    ) in printed
    assert 'packages=("sympy",),' in (tmp_path / "into" / "one" / "assignment.py").read_text()


def test_slugs_are_chosen_or_begin_alike(tmp_path, capsys):
    one = written(tmp_path / "a", "sums.ipynb", published())
    written(tmp_path / "b", "sums.ipynb", published())
    into = ["--into", str(tmp_path / "into")]
    with known():
        assert main(["import-notebook", str(one), *into, "--slug", "first-sums"]) == 0
        assert main(["import-notebook", str(one.parent), str(tmp_path / "b"), *into, "--prefix", "lab-"]) == 2
        assert main(["import-notebook", str(one), str(one), *into, "--slug", "x"]) == 2
    printed = capsys.readouterr()
    assert "first_sums: 5 of 5" in printed.out and "lab_sums: 5 of 5" in printed.out
    assert "the slug lab-sums is taken" in printed.err and "with --slug or --prefix" in printed.err
    assert "--slug names one assignment, and these are 2 notebooks: use --prefix" in printed.err


def test_notebooks_of_other_graders_are_named_and_the_rest_is_imported(tmp_path, capsys):
    of_nbgrader = published().replace('"metadata": {}', '"metadata": {"nbgrader": {"grade": true}}')
    written(tmp_path / "in", "a.ipynb", of_nbgrader)
    of_otter = notebook(("code", "a", [], "import otter\ngrader = otter.Notebook('b.ipynb')\n"))
    written(tmp_path / "in", "b.ipynb", of_otter)
    written(tmp_path / "in", "c.ipynb", published())
    with known():
        assert main(["import-notebook", str(tmp_path / "in"), "--into", str(tmp_path / "into")]) == 2
    printed = capsys.readouterr()
    assert "a.ipynb is a notebook of nbgrader: docs/authors/from-nbgrader-or-otter.md" in printed.err
    assert "b.ipynb is a notebook of Otter-Grader" in printed.err
    assert "c: 5 of 5 lines" in printed.out


def test_outputs_are_not_copied(tmp_path):
    big = json.dumps([{"output_type": "stream", "name": "stdout", "text": "x" * 10**6}])
    file = written(tmp_path, "sums.ipynb", published().replace('"outputs": []', f'"outputs": {big}'))
    with known():
        assert main(["import-notebook", str(file), "--into", str(tmp_path / "into")]) == 0
    assert (tmp_path / "into" / "sums" / "sums.ipynb").stat().st_size < 10**5


def test_a_cell_in_newer_python_is_named_and_nothing_is_left(tmp_path, capsys):
    newer = published(setup="def first[T](x: T) -> T: return x\nmatch\n= 1\n")
    file = written(tmp_path, "sums.ipynb", newer)
    assert main(["import-notebook", str(file), "--into", str(tmp_path / "into")]) == 2
    error = capsys.readouterr().err
    assert "sums.ipynb: code cell 1 is not valid Python: line" in error
    assert "newer syntax needs a server with a newer one)" in error and not (tmp_path / "into").exists()


def test_what_an_emptied_cell_imported_is_found_in_the_texts(tmp_path):
    lab = written(tmp_path / "lab", "__init__.py", "").parent
    written(tmp_path, "requirements.txt", "numpy\nsympy\npandas\n")
    text = notebook(
        ("markdown", "t", [], "# Symbols\nUse SymPy."),
        ("code", "a", [SOLUTION], "# (hidden)"),
        ("code", "v", ["validation"], 'validate.close(x, 1, "x is 1")'),
    )
    file = written(tmp_path, "symbols.ipynb", text)
    with known():
        command = ["import-notebook", str(file), "--into", str(tmp_path / "into"), "--package", str(lab)]
        assert main(command) == 0
    assert 'packages=("sympy",),' in (tmp_path / "into" / "symbols" / "assignment.py").read_text()


def test_a_course_module_that_cannot_be_imported_is_named_and_the_rest_is_imported(tmp_path, capsys):
    lab = written(tmp_path / "lab", "__init__.py", "").parent
    written(lab, "ring.py", "from lab.chain import b\na = 1\n")
    written(lab, "chain.py", "from lab.ring import a\nb = 1\n")
    written(tmp_path / "in", "one.ipynb", published(setup="from lab import ring\nfrom ecp import validate\n"))
    written(tmp_path / "in", "two.ipynb", published())
    command = ["import-notebook", str(tmp_path / "in"), "--into", str(tmp_path / "into")]
    with known():
        main([*command, "--package", str(lab)])
    printed = capsys.readouterr()
    assert "circular import" in printed.out + printed.err and "one" in printed.out + printed.err
    assert "two: 5 of 5 lines: 2 value shown" in printed.out
