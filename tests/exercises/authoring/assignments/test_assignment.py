import dataclasses
import sys

from exercises.authoring.assignments import validation
from exercises.authoring.assignments.assignment import Exercise
from exercises.authoring.assignments.catalogue import assignments, load_catalogue
from polhode.judging.checks import close
from tests.support.assignments import copied


def test_rigid_body_is_found_by_its_folder(rigid_body):
    assert rigid_body.folder.name == "rigid_body"
    assert [e.number for e in rigid_body.exercises] == ["1", "2", "3", "4", "5", "6"]


def test_a_new_assignment_is_a_new_folder(tmp_path, monkeypatch):
    import exercises

    copied(tmp_path, "second")
    before = set(assignments())
    monkeypatch.setattr(exercises, "__path__", [*exercises.__path__, str(tmp_path)])
    load_catalogue.cache_clear()
    try:
        assert set(assignments()) == before | {"second"}
    finally:
        for name in [name for name in sys.modules if name.startswith("exercises.second")]:
            del sys.modules[name]
        load_catalogue.cache_clear()


def test_all_errors_of_a_declaration_come_at_once(rigid_body):
    bad = close(
        "2-energy", "a   b", "nowhere", measured=lambda s: s, expected=0.0, rtol=-1.0, atol=0.0, reason=" "
    )
    broken = dataclasses.replace(rigid_body.scenes[-1], after="unknown")
    declared = dataclasses.replace(
        rigid_body,
        scenes=(*rigid_body.scenes, broken),
        exercises=(*rigid_body.exercises, Exercise("7", "t", (), (bad,))),
    )
    told = "; ".join(validation.errors(declared))
    for part in (
        "scene film is declared twice",
        "check id 2-energy is used twice",
        "no scene nowhere",
        "has no reason",
        "finite number",
        "three spaces",
        "comes after unknown",
    ):
        assert part in told


def test_the_notebooks_nine_lines_are_there_with_their_labels(rigid_body):
    labels = [
        c.label
        for e in rigid_body.exercises
        for c in e.checks
        if c.tolerance.reason == "the notebook's own tolerance"
    ]
    assert len(labels) == 8  # the ninth, on stability, has no tolerance of its own
    for label in (
        "principal moments match the analytic box result",
        "rotational energy conserved (torque-free)",
        "ω₃ is constant for the symmetric top",
        "free precession rate is (I₃−I₁)/I₁·ω₃",
    ):
        assert label in labels


def test_every_exercise_has_a_check_against_the_reference(rigid_body):
    """Answered with the truth of another situation, some check of each exercise must fail: it does read the
    reference.
    """
    against = {"1-boxes", "2-motion", "3-about-3", "4-motion", "5-growth", "6-attitude"}
    for exercise in rigid_body.exercises:
        assert against & {c.id for c in exercise.checks}, exercise.number
