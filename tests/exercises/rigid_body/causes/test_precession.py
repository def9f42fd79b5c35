"""Each mistake in a precession rate is named from the number alone, forwards and backwards."""

import numpy as np
import pytest

from exercises.rigid_body.causes import diagnose_scene
from service.grading.grade import draw_inputs


def phase(w, a=1, b=0):
    return np.unwrap(np.arctan2(w[a], w[b]))


def slope(t, w):
    return np.polyfit(t, phase(w), 1)[0]


def total(w):
    return phase(w)[-1] - phase(w)[0]


MISTAKES = {
    "degrees": (lambda t, w: np.degrees(slope(t, w)), "units", "degrees"),
    "rpm": (lambda t, w: slope(t, w) * 60 / (2 * np.pi), "units", "rpm"),
    "turns": (lambda t, w: slope(t, w) / (2 * np.pi), "units", "2π"),
    "half": (lambda t, w: slope(t, w) / 2, "constant-factor", "half"),
    "sign": (lambda t, w: -slope(t, w), "sign-reversed", "opposite sign"),
    "degrees, other way round": (lambda t, w: -np.degrees(slope(t, w)), "units", "opposite sign"),
    "per sample": (lambda t, w: total(w) / len(t), "wrong-times", "per sample"),
    "per step": (lambda t, w: np.polyfit(np.arange(len(t)), phase(w), 1)[0], "wrong-times", "per sample"),
    "over t[-1]": (lambda t, w: total(w) / t[-1], "wrong-times", "t[-1] − t[0]"),
    "phase over t": (lambda t, w: phase(w)[-1] / t[-1], "wrong-times", "t[-1] − t[0]"),
    "last step": (lambda t, w: (phase(w)[-1] - phase(w)[-2]) / (t[-1] - t[-2]), "wrong-times", "last step"),
    "ω₃ and ω₁": (lambda t, w: np.polyfit(t, phase(w, 2, 0), 1)[0], "wrong-components", "ω₃ and ω₁"),
    "ω₂ and ω₃": (lambda t, w: np.polyfit(t, phase(w, 1, 2), 1)[0], "wrong-components", "ω₂ and ω₃"),
    "not unwrapped": (lambda t, w: np.polyfit(t, np.arctan2(w[1], w[0]), 1)[0], "not-unwrapped", "np.unwrap"),
    "arctan": (lambda t, w: np.polyfit(t, np.arctan(w[1] / w[0]), 1)[0], "not-unwrapped", "arctan2"),
    "ω₃": (lambda t, w: w[2].mean(), "returns-input", "ω₃"),
    "period": (lambda t, w: 2 * np.pi / slope(t, w), "wrong-quantity", "period"),
    "angle": (lambda t, w: total(w), "wrong-quantity", "not divided by the time"),
    "intercept": (lambda t, w: np.polyfit(t, phase(w), 1)[1], "wrong-quantity", "other coefficient"),
}
EVEN = {
    "n first steps": lambda t, w: total(w) / (len(t) * (t[1] - t[0])),
    "gradient": lambda t, w: np.gradient(phase(w), t[1] - t[0]).mean(),
    "mean steps": lambda t, w: total(w) / (len(t) * np.diff(t).mean()),
}


@pytest.mark.parametrize("scene", ["rate", "rate-retrograde"])
def test_mistakes(scene, rigid_body):
    given = draw_inputs(rigid_body.scene(scene), 6)
    for name, (rate, code, said) in MISTAKES.items():
        if name == "last step" and scene == "rate":
            continue  # there the rate is the same at all times
        found = diagnose_scene(scene, given, {"rate": np.array(rate(given["t"], given["w"]))})
        assert found and {cause.code for cause in found} == {code}, (name, found)
        assert any(said in cause.sentence for cause in found), (name, found)


@pytest.mark.parametrize("name", EVEN)
def test_evenly_spaced_times_are_named_where_they_are_not(name, rigid_body):
    given = draw_inputs(rigid_body.scene("rate"), 6)
    (cause,) = diagnose_scene("rate", given, {"rate": np.array(EVEN[name](given["t"], given["w"]))})
    assert cause.code == "wrong-times" and "evenly spaced" in cause.sentence


def test_nearly_right_and_nothing_known(rigid_body):
    given = draw_inputs(rigid_body.scene("rate"), 6)
    right = slope(given["t"], given["w"])
    (cause,) = diagnose_scene("rate", given, {"rate": np.array(1.0041 * right)})
    assert cause.code == "nearly-right" and "0.0041" in cause.sentence
    for rate in (1.37 * right, 0.0, -0.91 * right, np.nan):
        assert diagnose_scene("rate", given, {"rate": np.array(rate)}) == []
    assert diagnose_scene("rate", given, {"rate": np.array(right)}) == []
