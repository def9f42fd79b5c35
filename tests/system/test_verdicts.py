"""The frozen verdicts: a share of the samples is graded as before, and a change is told in one line."""

import pytest

from exercises.authoring.assignments.catalogue import assignments
from tests.support.verdicts import SHARE, difference, differences, load, measure, subjects

SAMPLE = {"points": "2 of 5", "✓": ["2-energy"], "✗": ["2-motion"], "–": [], "codes": ["sign"]}


@pytest.mark.parametrize("slug", sorted(assignments()))
def test_a_share_of_the_samples_has_the_frozen_verdicts(slug):
    found = measure([slug], every=SHARE)
    assert len(found) > len(subjects(assignments()[slug])) // SHARE, "labels are compared too"
    assert not list(differences(load(), found, whole=False))


@pytest.mark.parametrize("slug", sorted(assignments()))
def test_every_sample_is_frozen(slug):
    names = {name for name in load() if name.startswith(f"{slug}/")}
    assert names == {f"{slug}/{one.name}" for one in subjects(assignments()[slug])}


def test_a_change_is_one_line_with_what_changed():
    assert difference(SAMPLE, dict(SAMPLE)) == ""
    now = {"points": "5 of 5", "✓": ["2-energy", "2-motion"], "✗": [], "–": ["2-new"], "codes": ["shape"]}
    told = difference(SAMPLE, now)
    parts = ["points 2 of 5 → 5 of 5", "2-motion ✗ → ✓", "2-new absent → –", "code +shape", "code −sign"]
    assert told == ", ".join(parts)
    assert difference({"label": "T is conserved"}, {"label": "T stays"}) == "label T is conserved → T stays"
    assert difference(SAMPLE, {"fault": "no sandbox"}).endswith('→ {"fault": "no sandbox"}')


def test_new_and_missing_samples_differ():
    (new,) = differences({"a": SAMPLE}, {"b": SAMPLE}, whole=False)
    assert new.startswith("b: new: ")
    told = [*differences({"a": SAMPLE}, {"b": SAMPLE}, whole=True)]
    assert [line[:7] for line in told] == ["b: new:", "a: gone"]
