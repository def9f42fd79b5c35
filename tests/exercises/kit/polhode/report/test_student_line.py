"""The student's line that a failure is about: found without parsing, in every way to write a component."""

import time

import pytest

from exercises.authoring.assignments.catalogue import find
from polhode.report.student_line import MOST, StudentLine, of_component, raised

HEAD = "def f(t, w, I):\n"


def about(source, k=1, name="f"):
    """The place and the marked part of the line of component ``k``, None if no line is evident."""
    line = of_component([("cell 1", source)], name, k)
    return line and (line.number, line.parts()[1])


@pytest.mark.parametrize(
    ("body", "found"),
    [
        ("    return np.array([w[0], a(1, 2) * w[1], w[2]])\n", (2, "a(1, 2) * w[1]")),
        ("    return [\n        w[0],\n        w[1] / I[1],  # second\n    ]\n", (4, "w[1] / I[1]")),
        ("    return w[0], w[1], w[2]\n", (2, "w[1]")),
        ("    return (w[0], w[1])\n", (2, "w[1]")),
        ("    a = 1\n    b = w[0] * w[2]\n    return np.array([a, b])\n", (3, "b = w[0] * w[2]")),
        ("    out = np.zeros(3)\n    out[1] = w[0]\n    return out\n", (3, "out[1] = w[0]")),
        ("    d = np.array([w[0], w[1]])\n    return d\n", (2, "w[1]")),
        ("    a, b = I\n    return np.array([[a * 1], [b * 2]])\n", (3, "[b * 2]")),
        (
            "    if t:\n        return 0\n    return [w[0], {1: 2, 3: 4}[w[1]], 0]\n",
            (4, "{1: 2, 3: 4}[w[1]]"),
        ),
        ("    return [w[0], w[1] * (\n        I[0]), 0]\n", (2, "w[1] * (")),
        ("    return np.cross(I * w, w) / I\n", None),
        ("    return np.array([w[0]]) \n", None),
        ("    return helper(w, I)\n", None),
        ("    pass\n", None),
    ],
)
def test_a_component_is_found_where_it_is_computed(body, found):
    assert about(HEAD + body) == found
    assert about(f"# before\n{HEAD}{body}\nx = [7, 8, 9]\n") == (found and (found[0] + 1, found[1]))


def test_lambdas_and_functions_on_one_line_are_read_too():
    assert about("f = lambda t, w, I: [w[0], w[1]]\n") == (1, "w[1]")
    assert about("def f(t, w, I): return w[0], w[1]\n") == (1, "w[1]")
    assert about("class A:\n    def f(self, w):\n        return w[0], w[1]\n") == (3, "w[1]")


def test_the_last_definition_counts_and_a_cell_that_is_no_python_is_passed_over():
    cells = [("cell 1", HEAD + "    return 1, 2\n"), ("cell 2", "%time f(\n"), ("cell 4", "g = 'def f'\n")]
    assert str(of_component(cells, "f", 0)) == "cell 1, line 2: return 1, 2"
    twice = "def f(w):\n    return 1, 2\n\n\ndef f(w):\n    return 3, 4\n"
    assert str(of_component([("cell 1", twice)], "f", 0)) == "cell 1, line 6: return 3, 4"
    cells[1:1] = [("cell 3", "x = 1\n\n" + HEAD + "    return 3, 4\n")]
    assert of_component(cells, "f", 1, "a sentence") == StudentLine(
        "cell 3", 4, "return 3, 4", 10, 11, "a sentence"
    )


@pytest.mark.parametrize(
    "body",
    [
        "    return " + "(" * 100_000,
        "    return [" + "[" * 50_000 + "]" * 50_000 + ", 1]",
        "    return [" + "1," * 100_000 + "]",
        "    return a\n" + "    a = a\n" * 20_000,
        "    return [1, '''",
        "  return 1\n return 2\n",
        "    return [1, 2\x00]",
        "    return [1, " + "9" * 200_000 + "]",
        "    return [0, 1, \ud800]",
    ],
    ids=range(9),
)
def test_hostile_source_takes_no_time_and_raises_nothing(body):
    began = time.process_time()
    line = of_component([("cell 1", HEAD + body)], "f", 1)
    assert time.process_time() - began < 15.0, "it is linear, some seconds on a slow processor"
    assert line is None or (len(line.text) <= MOST and line.text.isprintable())


SIGNS = {"first": 0, "second": 1, "third": 2}


@pytest.mark.parametrize("which", SIGNS)
def test_the_samples_with_a_wrong_sign_show_it_in_the_marked_part(which):
    source = (find("rigid-body").folder / "samples" / f"wrong_sign_{which}.py").read_text()
    line = of_component([("submission.py", source)], "euler_eqs", SIGNS[which])
    assert line is not None and line.parts()[1] in source and "return" not in line.parts()[1]


@pytest.mark.parametrize(
    ("traceback", "shown", "marked"),
    [
        (None, "None", ""),
        ("ZeroDivisionError: division by zero\n", "None", ""),
        (
            '  File "cell 3", line 2\n    return (\n           ^\nSyntaxError: no\n',
            "cell 3, line 2: return (",
            "(",
        ),
        ('  File "a.py", line 1, in <module>\n  File "b.py", line 7, in f\nNo: x\n', "b.py, line 7", ""),
        (
            '  File "/tmp/ipykernel_7/12.py", line 4, in f\n    return 1 / x\n           ~~^~~\nNo: x\n'
            '  File "x", line 9\n',
            "line 4: return 1 / x",
            "1 / x",
        ),
        ('  File "<ipython-input-3-ab>", line 5, in f\n    y\nNo\n', "line 5: y", "y"),
    ],
)
def test_the_last_line_of_a_traceback_with_its_place_and_what_its_carets_mark(traceback, shown, marked):
    line = raised(traceback)
    assert str(line) == shown and (line is None or line.parts()[1] == marked)
