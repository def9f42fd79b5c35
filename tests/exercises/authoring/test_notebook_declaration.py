"""The Kepler problem in the declared form, and every error of such a declaration at once, with its line."""

import numpy as np
import pytest

from exercises.authoring.publishing import public_assignment
from service.grading.grade import grade
from service.grading.sandbox_job import draw_inputs, job_of, truth
from service.grading.submission import Submission
from tests.support.assignments import known
from tests.support.checkout import ROOT

KEPLER = ROOT / "docs/tutorials/kepler"


@pytest.fixture(scope="module")
def kepler():
    with known(KEPLER) as catalogue:
        assert not catalogue.invalid
        yield catalogue.valid["kepler"]


def test_exercises_and_titles_are_those_of_the_notebook(kepler):
    assert kepler.title == "The Kepler problem"
    assert [(e.number, e.title, e.functions) for e in kepler.exercises] == [
        ("1", "The equation of motion", ("kepler_eqs",)),
        ("2", "Elements of an orbit", ("orbital_elements",)),
        ("3", "Kepler's equation", ("eccentric_anomaly",)),
        ("4", "A step of the leapfrog method", ("leapfrog",)),
        ("5", "The perihelion advances", ("precession",)),
        ("6", "An animation", ("animate_orbit",)),
    ]


def test_points_are_those_of_the_exercises(kepler):
    assert [kepler.max_points([e.number]) for e in kepler.exercises] == [6, 4, 8, 6, 4, 2]


def test_a_label_names_the_case(kepler):
    labels = [check.label for check in kepler.exercise("3").checks]
    assert labels[0] == "eccentric_anomaly is right for an array"
    assert "eccentric_anomaly is right for a single number (new inputs)" in labels


def test_truths_see_every_drawn_name_and_the_job_only_what_the_function_takes(kepler):
    scene = kepler.scene("2-hidden")
    inputs = draw_inputs(scene, 5)
    assert {"y", "mu", "a", "e", "omega"} == set(inputs)
    (request,) = job_of(Submission(""), kepler, [scene], {scene.name: inputs}).scenes
    assert set(request.inputs) == {"y", "mu"}
    exact = truth(scene, inputs)
    assert np.array_equal(exact["e"], inputs["e"])


def test_the_kit_has_no_drawn_name_that_the_function_does_not_take(kepler):
    public = public_assignment._content("kepler")["public.json"].decode()
    assert '"mu"' in public and '"omega": [' not in public


def test_constants_of_given_cells_between_exercises_are_setup(kepler):
    assert "delta = 0.05" in kepler.setup and "start = np.array" in kepler.setup


def test_a_later_exercise_uses_the_solution_that_its_source_calls(kepler):
    (question,) = kepler.questions["5"]
    assert question["uses"] == ["kepler_eqs"]


def test_the_authors_notebook_gets_all_points(kepler, sandbox):
    notebook = (KEPLER / "kepler.ipynb").read_bytes()
    report = grade(Submission.from_bytes(notebook, "kepler.ipynb"), kepler, sandbox, 3).report
    assert report.passed, report.text()


def test_an_angle_may_differ_by_full_turns(kepler, sandbox):
    (right,) = [s for s in kepler.made_samples() if s.name == "right_all.py"]
    turned = right.source + (
        "\n_elements = orbital_elements\n\n\ndef orbital_elements(y, mu):\n"
        "    a, e, omega = _elements(y, mu)\n    return a, e, omega - 4 * np.pi\n"
    )
    assert grade(Submission(turned), kepler, sandbox, 3, ["2"]).report.passed


def errors(tmp_path, *changes, notebook=lambda text: text):
    """The errors of the Kepler problem with these changes of its declaration."""
    folder = tmp_path / "changed"
    folder.mkdir()
    text = (KEPLER / "assignment.py").read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    (folder / "assignment.py").write_text(text)
    (folder / "kepler.ipynb").write_text(notebook((KEPLER / "kepler.ipynb").read_text()))
    with known(folder) as catalogue:
        return catalogue.invalid["changed"].errors if catalogue.invalid else []


def lines_of(text):
    """The numbers of the lines of the declaration that contain the text."""
    lines = (KEPLER / "assignment.py").read_text().splitlines()
    return [number for number, line in enumerate(lines, 1) if text in line]


ANOMALY = '"eccentric_anomaly")'
CHANGE, ELEMENTS = "    kepler_eqs.mistake(", '"orbital_elements", inputs'


@pytest.mark.parametrize(
    ("old", "new", "at", "error"),
    [
        ('"missing-term"', '"upside-down"', CHANGE, "there is no diagnosis code upside-down"),
        ('exercise("3"', 'exercise("1a) first"', 'exercise("3"', "'1a) first' is no exercise number"),
        ('"orbital_elements", inputs', '"elements", inputs', ELEMENTS, "defines the function elements"),
        ("-mu * position -> -", "-nu * position -> -", CHANGE, "is not in kepler_eqs"),
        ("-mu * position -> -", "position -> -", CHANGE, "occurs 3 times in kepler_eqs"),
        ("elements.agree(\n", "elements.agree(\n        b=1,\n", "elements.agree(", "a, e, omega, not b"),
        ("E = M\n", "E = M * unknown\n", "@anomaly.mistake(", "stops_early: it uses unknown"),
        ('"a": a, ', "", ELEMENTS, "takes a, which is neither asked nor drawn"),
        ("p = a * (1 - e**2)", "p = a / 0", "p = a * (1 - e**2)", "ZeroDivisionError"),
        ("    @step.rates\n", "", "step.case(", "decorate with @question.rates a function"),
        ("order=(2, absolute(", "order=(2, relative(", "step.case(", "order[1] is a tolerance of limit=0.2"),
        ("order=(2, absolute(", "order=(2, relative(", "step.case(", "it must be absolute(…, because=…)"),
        ("until=12,", "until=None,", "ask.right_hand_side(", "a motion needs until= and follow="),
        ('"eccentric_anomaly")', '"eccentric_anomaly", uses=1)', '"eccentric_anomaly")', "leave it out"),
        (ANOMALY, '"eccentric_anomaly", call=1)', ANOMALY, "it has name, inputs"),
        ("cell.mistake(\n", "cell.agree(\n", "cell.mistake(", "no agree: it has truth, claim, mistake"),
        ('"precession", agree', '"a", agree', '@cell.truth("', "own truth and tolerance"),
        ("draw(with_ends(0.05, 0.9))", "draw((0.05, 0.9))", "mu, a, e = ", "(0.05, 0.9) is no draw"),
        ("draw(with_ends(0.05, 0.9))", 'draw(expression("x", of="x"))', "mu, a, e = ", "give it to a case"),
        ("h=between(0.02, 0.2)", "h=lambda rng, x: 1", "step.case(", "the draw of h takes x: it is called"),
        ('"2", points=4', '"2", points=2', '"2", points=4', "a wrong one would cost nothing"),
    ],
)  # fmt: skip
def test_an_error_has_its_line_and_says_what_is_wrong(tmp_path, old, new, at, error):
    found = errors(tmp_path, (old, new))
    line = lines_of(at)[0]
    assert len(found) == 1 and found[0].startswith(f"assignment.py line {line}: ") and error in found[0]


def test_all_errors_of_a_declaration_are_reported_at_once(tmp_path):
    found = errors(
        tmp_path,
        ('"component-order"', '"interleaved"'),
        ("-mu * position -> -", "-nu * position -> -"),
        ('exercise("3"', 'exercise("three"'),
        ('"leapfrog",\n        state', '"frog",\n        state'),
    )
    assert [line.split(": ")[0] for line in found] == [
        f"assignment.py line {lines_of(text)[0]}"
        for text in (CHANGE, '"component-order"', 'exercise("3"', "ask.step(")
    ]


def test_a_solution_that_two_cells_define_is_an_error(tmp_path):
    twice = "def leapfrog(acc, x, v, h):\\n    return x, v\\n\\n\\ndef with_correction(t, y):"
    found = errors(tmp_path, notebook=lambda text: text.replace("def with_correction(t, y):", twice))
    assert len(found) == 1 and "2 cells of the notebook define leapfrog" in found[0]


def test_a_notebook_without_a_heading_of_the_exercise_is_an_error(tmp_path):
    found = errors(tmp_path, notebook=lambda text: text.replace("## Exercise 4: ", "## "))
    assert len(found) == 1 and "has no heading that begins with Exercise 4" in found[0]
