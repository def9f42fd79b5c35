"""The text below the chart of speed against accuracy, from numbers."""

from dataclasses import replace

import pytest

from exercises.authoring.assignments.assignment import Scene, Sweep
from exercises.authoring.assignments.speed_vs_accuracy import SETTINGS, compared
from polhode.judging.outcome import SweepResult, SweptPoint

KAPPA = 72.7
SWEEP = Sweep(
    Scene("s", "p", "f", {}, {}, lambda inputs: {}, budget_s=1.0),
    lambda seen, exact: None,
    1e-8,
    lambda: KAPPA,
    lambda: None,
)


def result(per_call, overhead=8e-6, errors=None, stopped=()):
    """A run of 1000 calls for each setting, with an error as large as its tolerance."""
    points = []
    for k, (solver, rtol) in enumerate(SETTINGS):
        seconds, calls = 1000 * (per_call + overhead), 20_001 if k in stopped else 1000
        error = None if k in stopped else (errors or {}).get(rtol, rtol)
        points.append(SweptPoint(solver, rtol, calls, error, seconds, stopped=k in stopped))
    return SweepResult("exercise 2", points, "", per_call=[per_call])


RIGHT = result(2e-6)


def text(mine, right=RIGHT):
    return compared(mine, right, SWEEP, "f").line.split("; ")


def test_which_solver_is_enough_comes_first_then_what_each_change_would_save():
    slow, fast = text(result(90e-6)), text(result(1e-6))
    assert slow[0].startswith(
        "DOP853 at rtol 1e-09 is enough: it has an error of 1e-09, and 1e-08 is allowed, in "
    )
    assert slow[1] == "one call of f takes 90 µs, of the solution 2 µs (×45)"
    assert slow[2] == (
        "DOP853 at rtol 1e-11 makes 1000 calls in 98 ms, 90 ms of it in f: a function as fast as the solution"
        " would save 88 ms of these"
    )
    assert fast[2].endswith("9 ms, 1 ms of it in f: fewer calls help, a faster function does not")
    assert text(result(2.2e-6))[1] == "one call of f takes 2.2 µs, about as long as of the solution"
    assert text(result(90e-6), None)[2].endswith("a faster function would save up to 90 ms of these")


def test_a_run_that_was_stopped_is_rounding_noise_and_single_precision_is_named():
    noisy = result(50e-6, errors={rtol: 4e-6 for _, rtol in SETTINGS}, stopped=(3, 4, 5))
    missed, noise = text(noisy)
    assert "no run gets below an error of 4e-06, and 1e-08 is allowed" in missed
    assert "κ·2⁻²³ = 9e-06" in missed and "float64" in missed
    assert noise == "3 of 16 runs were stopped at rounding noise (crosses)"


def test_a_function_with_which_no_run_ends_has_no_least_error():
    assert text(result(50e-6, errors={rtol: None for _, rtol in SETTINGS}, stopped=(3,))) == [
        "no run reaches the end: check f first"
    ]


@pytest.mark.parametrize("error", [4e-6, 1.9])
def test_a_wrong_function_that_no_noise_stops_is_not_called_single_precision(error):
    (missed,) = text(result(1e-6, errors={rtol: error for _, rtol in SETTINGS}))
    assert missed.endswith("check f first")


def test_what_is_known_stands_beside_the_points():
    found = compared(RIGHT, replace(RIGHT), SWEEP, "f")
    assert found.reference == RIGHT.points and found.per_call == [2e-6, 2e-6]
    assert (found.tolerance, found.sensitivity) == (1e-8, KAPPA) and found.closed_form >= 0
    alone = compared(RIGHT, None, replace(SWEEP, exact=None, sensitivity=None), "f")
    assert alone.reference == [] and alone.per_call == [2e-6] and alone.closed_form is None


def test_steppers_stand_beside_those_of_the_solution():
    mine = SweepResult(
        "s", [SweptPoint("euler_step", None, 50, 1e-2, 1e-3, 0.1)], "for an error of 1e-3: mine"
    )
    assert text(mine, replace(mine, line="for an error of 1e-3: theirs")) == [
        "for an error of 1e-3: mine",
        "the solution: for an error of 1e-3: theirs",
    ]
