"""Each mistake in a precession rate is named from its numbers in all motions together."""

import numpy as np
import pytest

from exercises.rigid_body.causes import diagnose_function
from exercises.rigid_body.draws import TURNING
from service.grading.jobs import draw_inputs


def phase(w, a=1, b=0):
    return np.unwrap(np.arctan2(w[a], w[b]))


def slope(t, w):
    return np.polyfit(t, phase(w), 1)[0]


def total(w):
    return phase(w)[-1] - phase(w)[0]


def raw(w):
    return np.arctan2(w[1], w[0])


def spectral_line(t, w):
    """The highest line of the spectrum of ω₁ + iω₂, resampled at even times."""
    even = np.linspace(t[0], t[-1], len(t))
    lines = np.abs(np.fft.fft(np.interp(even, t, w[0]) + 1j * np.interp(even, t, w[1])))
    return 2 * np.pi * np.fft.fftfreq(len(t), even[1] - even[0])[lines.argmax()]


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
    "last phase": (lambda t, w: phase(w)[-1] / (t[-1] - t[0]), "wrong-times", "first phase"),
    "reshaped": (
        lambda t, w: np.polyfit(t, phase(w.reshape(-1, 3).T), 1)[0],
        "wrong-components",
        "does not transpose",
    ),
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
    "n - 1 first steps": lambda t, w: total(w) / ((len(t) - 1) * (t[1] - t[0])),
    "gradient": lambda t, w: np.gradient(phase(w), t[1] - t[0]).mean(),
}
MISTAKES |= {name: (rate, "wrong-times", "evenly spaced") for name, rate in EVEN.items()}
MISTAKES |= {
    "one component": (
        lambda t, w: slope_of(t, np.unwrap(np.arccos(w[0] / np.hypot(w[0], w[1])))),
        "wrong-components",
        "one comp",
    ),
    "degrees unwrapped": (
        lambda t, w: np.radians(slope_of(t, np.unwrap(np.degrees(raw(w))))),
        "not-unwrapped",
        "period=360",
    ),
    "spectrum": (lambda t, w: spectral_line(t, w), "wrong-quantity", "Fourier"),
    "absolute value": (lambda t, w: abs(slope(t, w)), "absolute-value", "sign is lost"),
    "n mean steps": (
        lambda t, w: total(w) / (len(t) * np.diff(t).mean()),
        "wrong-times",
        "number of its terms",
    ),
    "n of n - 2": (
        lambda t, w: np.gradient(phase(w), t)[1:-1].sum() / len(t),
        "wrong-times",
        "number of its terms",
    ),
    "0.6 ω₃": (lambda t, w: 0.6 * w[2].mean(), "hard-coded-moments", "0.6 ω₃: the rate of one body"),
    "1.37 times": (lambda t, w: 1.37 * slope(t, w), "constant-factor", "1.37 times"),
    "modulo": (
        lambda t, w: (np.diff(np.arctan2(w[1], w[0])) % (2 * np.pi)).sum() / np.ptp(t),
        "not-unwrapped",
        "modulo 2π",
    ),
    "median of raw jumps": (
        lambda t, w: np.median(np.diff(np.arctan2(w[1], w[0])) / np.diff(t)),
        "not-unwrapped",
        "np.unwrap",
    ),
    "arctan unwrapped": (
        lambda t, w: slope_of(t, np.unwrap(np.arctan(w[1] / w[0]), period=np.pi)),
        "not-unwrapped",
        "quadrants",
    ),
    "arcsin": (lambda t, w: np.arcsin(cross(w)).sum() / np.ptp(t), "not-unwrapped", "quarter of a turn"),
    "derivatives": (lambda t, w: np.mean(derivatives(t, w)), "partly-right", "needs fine samples"),
    "zero": (lambda t, w: 0.0, "returns-zero", "zero"),
}


def slope_of(t, phase):
    return np.polyfit(t, phase, 1)[0]


def cross(w):
    r = np.hypot(w[0], w[1])
    return (w[0][:-1] * w[1][1:] - w[1][:-1] * w[0][1:]) / (r[:-1] * r[1:])


def derivatives(t, w):
    return (w[0] * np.gradient(w[1], t) - w[1] * np.gradient(w[0], t)) / (w[0] ** 2 + w[1] ** 2)


def causes(rate, rigid_body, scenes=tuple(TURNING), seed=6):
    given = {scene: draw_inputs(rigid_body.scene(scene), seed) for scene in scenes}
    answers = {
        scene: (inputs, {"rate": np.array(rate(inputs["t"], inputs["w"]))}) for scene, inputs in given.items()
    }
    return diagnose_function("precession_rate", answers)


@pytest.mark.parametrize("seed", [6, 7, 8])
@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_named_that_explains_all_motions(name, seed, rigid_body):
    rate, code, said = MISTAKES[name]
    (cause,) = causes(rate, rigid_body, seed=seed)
    assert cause.code == code and said in cause.sentence


@pytest.mark.parametrize("scene", ["rate", "rate-retrograde"])
def test_a_mistake_is_named_where_one_motion_alone_was_measured(scene, rigid_body):
    for name in (
        "degrees",
        "rpm",
        "turns",
        "half",
        "per sample",
        "ω₃ and ω₁",
        "not unwrapped",
        "arctan",
        "period",
        "angle",
    ):
        rate, code, said = MISTAKES[name]
        found = causes(rate, rigid_body, [scene])
        assert found and {cause.code for cause in found} == {code}, (name, found)
        assert any(said in cause.sentence for cause in found), (name, found)


def test_a_cause_that_another_motion_contradicts_is_not_given(rigid_body):
    def first_alone(t, w):
        return slope(t, w) * (3 if np.ptp(np.diff(t)) > 1e-9 else 1)

    (cause,) = causes(first_alone, rigid_body)
    assert cause.code == "partly-right" and cause.sentence.endswith(", but wrong for uneven times")


def test_nearly_right_and_nothing_known(rigid_body):
    (cause,) = causes(lambda t, w: (1.004 + 1e-3 * np.sign(w[0][0])) * slope(t, w), rigid_body, seed=7)
    assert cause.code == "nearly-right" and "0.005" in cause.sentence
    assert causes(lambda t, w: (1.3 + 0.1 * np.sin(t[0])) * slope(t, w), rigid_body) == []
    assert causes(lambda t, w: np.nan, rigid_body) == []
    assert causes(slope, rigid_body) == []
