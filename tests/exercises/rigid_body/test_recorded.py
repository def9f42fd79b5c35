"""Functions that repeat a recorded motion need not be integrated: they get the same report, and no other
function does.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from ecp.document import document
from exercises.assignment import Recorded, Recording
from exercises.rigid_body.plays import EVERY, FIRST_CALLS, sampled, trajectory
from exercises.rigid_body.recorded import recorded
from service.grading.grade import grade
from service.grading.rendering import pack, unpack
from service.grading.submission import Submission

START = "import numpy as np\ndef euler_eqs(t, w, I):\n    "
TERMS = "(w1, w2, w3), (I1, I2, I3) = w, I\n    return np.array([{}])"
REPEATED = {
    "cross product": START + "return np.cross(I * w, w) / I",
    "other cross product": START + "return -np.cross(w, I * w) / I",
    "terms": START + TERMS.format("(I2-I3)*w2*w3/I1, (I3-I1)*w3*w1/I2, (I1-I2)*w1*w2/I3"),
    "ratios": START + TERMS.format("(I2-I3)/I1*w2*w3, (I3-I1)/I2*w3*w1, (I1-I2)/I3*w1*w2"),
    "ratios of products": START + TERMS.format("(I2-I3)/I1*(w2*w3), (I3-I1)/I2*(w3*w1), (I1-I2)/I3*(w1*w2)"),
}
OTHERS = {
    "right, with other roundings": START + "return np.cross(I * w, w) * (1 / I)",
    "a list": START + "return list(np.cross(I * w, w) * (1 / I))",
    "wrong": START + "return np.cross(w, I * w) / I",
    "right at first": START + "return np.cross(I * w, w) / I * (1 if t < 19.9 else 1 + 1e-15)",
    "raises at last": START + "return np.cross(I * w, w) / I if t < 19.9 else 1 / 0",
    "two numbers": START + "return np.cross(I * w, w)[:2]",
    "not finite": START + "return np.cross(I * w, w) / I + (np.nan if t > 1 else 0)",
}
CLAIMS = """
import hashlib, sys
import numpy as np

def euler_eqs(t, w, I):
    frame = sys._getframe(1)
    while frame is not None and frame.f_code.co_name != "trajectory":
        frame = frame.f_back
    sample = {} if frame is None else frame.f_locals["inputs"].get("sample", {})
    for digests in sample.get("digests", ()):
        digests[:] = (hashlib.sha256(bytes(24 * k)).hexdigest() for k in (16, len(sample["offsets"])))
    return np.zeros(3)
"""


def asked(known, seed):
    """Return the inputs by which a play recognises the recorded motions."""
    return {
        "recorded": [one.calls.tobytes() for one in known.recordings],
        "sample": known.sample(known.recordings, np.random.default_rng(seed)),
    }


BODY = {"w0": [1.0, 0.6, 0.8], "I": [2.0, 3.0, 4.0], "t_end": 2.0, "n": 50, "orientation": True}


@pytest.fixture(scope="module")
def prepared(rigid_body):
    """The assignment with recorded motions of exercise 2, which the fixture of the other tests does not
    have.
    """

    def with_recorded(scene):
        if scene.name != "torque-free":
            return scene
        known = Recorded(scene.recorded.make, scene.recorded.sample)
        known.prepare()
        return replace(scene, recorded=known)

    return replace(rigid_body, scenes=tuple(map(with_recorded, rigid_body.scenes)))


def report(source, assignment, sandbox):
    """Return the report without how the motion was made, all arrays, and how."""
    graded = grade(Submission(source), assignment, sandbox, 3, ["2"])
    how = graded.report.provenance.motions.pop("torque-free", "")
    arrays = {
        name: {key: np.asarray(array).tobytes() for key, array in found.items()}
        for name, found in graded.arrays.items()
    }
    return document(graded.report), arrays, how


@pytest.mark.parametrize("source", REPEATED.values(), ids=REPEATED)
def test_a_function_that_repeats_a_recorded_motion_gets_the_same_numbers_without_an_integration(
    source, prepared, rigid_body, sandbox
):
    *numbers, how = report(source, prepared, sandbox)
    assert numbers[0]["exercises"][0]["outcomes"][0]["verdict"] == "pass"
    assert how.startswith(
        "not integrated: euler_eqs repeats one of every four calls of a recorded integration"
    )
    *computed, how = report(source, rigid_body, sandbox)
    assert numbers == computed and how.startswith("computed in the sandbox")


@pytest.mark.parametrize("source", OTHERS.values(), ids=OTHERS)
def test_any_other_function_is_integrated(source, prepared, rigid_body, sandbox):
    *numbers, how = report(source, prepared, sandbox)
    assert "recorded" not in how and numbers == list(report(source, rigid_body, sandbox)[:2])


def test_a_function_that_claims_to_repeat_a_recorded_motion_is_integrated_by_the_host(prepared, sandbox):
    found, _, how = report(CLAIMS, prepared, sandbox)
    outcomes = {outcome["id"]: outcome["verdict"] for outcome in found["exercises"][0]["outcomes"]}
    assert outcomes["2-motion"] == "fail" and how.startswith("integrated by the host")


@pytest.mark.parametrize(
    ("source", "scenes"), [(REPEATED["terms"], {"torque-free"}), (CLAIMS, set())], ids=["repeated", "claimed"]
)
def test_arrays_are_those_of_a_recording_only_if_they_were_judged(source, scenes, prepared, sandbox):
    graded = grade(Submission(source), prepared, sandbox, 3, ["2"])
    assert graded.recorded.keys() == scenes
    packed = unpack(pack(graded).values())
    assert packed["torque-free"]["w"].tobytes() == np.asarray(graded.arrays["torque-free"]["w"]).tobytes()


@pytest.mark.parametrize("number", [-1.0, 4.0, 0.5, float("nan"), float("inf")])
def test_a_number_that_no_recorded_motion_has_recalls_none(number):
    known = Recorded(
        lambda: [Recording(np.zeros((0, 4)), np.zeros((0, 3)), {"w": np.zeros(3)})] * 4, lambda *_: {}
    )
    known.prepare()
    assert known.recall(np.array(number)) is None
    assert known.recall(np.array(3.0)) is known.recordings[3]


def test_another_function_is_recognised_after_a_few_calls():
    known, calls = recorded(BODY), []
    known.prepare()

    def with_other_roundings(t, w, I):
        calls.append(t)
        return np.cross(I * w, w) * (1 / I)

    mine = trajectory({"euler_eqs": with_other_roundings}, {**BODY, **asked(known, 3)})
    tried = len(calls)
    calls.clear()
    assert trajectory({"euler_eqs": with_other_roundings}, BODY)["w"].tobytes() == mine["w"].tobytes()
    assert tried == len(calls) + FIRST_CALLS * len(known.recordings)


def test_a_function_that_differs_for_less_than_a_step_of_the_integration_is_integrated():
    known = recorded(BODY)
    known.prepare()
    calls, cross = known.recordings[0].calls, lambda t, w, I: np.cross(I * w, w) / I
    for seed, first in enumerate(range(0, len(calls) - 2 * EVERY + 1, 5)):
        stretch = {row.tobytes() for row in calls[first : first + 2 * EVERY]}
        inputs = {**BODY, **asked(known, seed)}

        def differs(t, w, I, stretch=stretch):
            return cross(t, w, I) * (1 + 1e-15 * (np.array([t, *w]).tobytes() in stretch))

        assert trajectory({"euler_eqs": cross}, inputs)["recorded"] == 0
        assert "recorded" not in trajectory({"euler_eqs": differs}, inputs), (
            f"calls {first} to {first + 2 * EVERY}"
        )


@pytest.mark.parametrize("n", [4, 7, 401])
def test_the_sample_has_one_of_every_four_calls_and_another_one_for_each_seed(n):
    rows = np.arange(n)[:, None] * np.ones(4)
    offsets = np.random.default_rng(n).integers(0, EVERY, 200).tolist()
    assert (sampled(rows, offsets)[:, 0] // EVERY).tolist() == list(range(math.ceil(n / EVERY)))
    known = recorded(BODY)
    known.prepare()
    assert known.sample(known.recordings, np.random.default_rng(1)) != known.sample(
        known.recordings, np.random.default_rng(2)
    )
