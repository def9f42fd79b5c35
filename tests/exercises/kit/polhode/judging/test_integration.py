"""The integrator returns the numbers of SciPy's ``solve_ivp`` to the last bit, with the same calls."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from polhode.judging.integration import STOPPED, IntegrationStopped, integrate

MOMENTS = np.array([2.0, 3.0, 4.0])
PROBLEMS = {
    "rigid body": (
        lambda t, w: np.cross(MOMENTS * w, w) / MOMENTS,
        [1.0, 0.6, 0.8],
        np.linspace(0.0, 20.0, 3100),
        1e-11,
        1e-13,
    ),
    "van der Pol": (
        lambda t, y: np.array([y[1], 30 * (1 - y[0] ** 2) * y[1] - y[0]]),
        [2.0, 0.0],
        np.linspace(0, 60, 77),
        1e-8,
        1e-9,
    ),
    "forced": (lambda t, y: np.array([np.cos(9 * t) * y[0]]), [1.0], np.linspace(3.0, 7.0, 11), 1e-6, 1e-8),
    "many states": (
        lambda t, y: np.roll(y, 1) - y**3,
        np.linspace(-1, 1, 37),
        np.array([0.0, 0.1, 5.0, 5.1, 30.0]),
        1e-9,
        1e-9,
    ),
    "at rest": (lambda t, y: np.zeros(3), [1.0, 2.0, 3.0], np.linspace(0.0, 10.0, 100), 1e-11, 1e-13),
    "from zero": (lambda t, y: np.array([1.0, t]), [0.0, 0.0], np.linspace(0.0, 1.0, 5), 1e-11, 1e-13),
    "a jump": (
        lambda t, y: np.array([-1.0 if y[0] > 0.5 else -3.0]),
        [1.0],
        np.linspace(0.0, 1.0, 9),
        1e-10,
        1e-12,
    ),
    "tolerances of each state": (
        lambda t, y: np.array([y[1], -y[0]]),
        [1e6, 1.0],
        np.linspace(0, 9, 50),
        1e-9,
        np.array([1e-3, 1e-9]),
    ),
}


def recorded(function):
    """Return ``function`` in the form for solve_ivp, in that for integrate, and the list of the calls of
    both.
    """
    calls = []

    def plain(t, y):
        calls.append((float(t), y.tobytes()))
        return function(t, y)

    return plain, lambda y, out: lambda t: out.put(range(len(y)), plain(t, y.copy())), calls


@pytest.mark.parametrize(
    ("function", "start", "times", "rtol", "atol"), PROBLEMS.values(), ids=PROBLEMS.keys()
)
def test_numbers_and_calls_are_those_of_scipy(function, start, times, rtol, atol):
    plain, into, calls = recorded(function)
    expected = solve_ivp(
        plain, (times[0], times[-1]), start, method="DOP853", t_eval=times, rtol=rtol, atol=atol
    )
    theirs, calls[:] = list(calls), []
    assert np.array_equal(integrate(into, start, times, rtol, atol), expected.y)
    assert calls == theirs


def test_a_motion_that_ends_early_stops_where_scipys_does():
    plain, into, calls = recorded(lambda t, y: y**2)
    times = np.linspace(0.0, 2.0, 50)
    with np.errstate(all="ignore"):
        expected = solve_ivp(plain, (0.0, 2.0), [1.0], method="DOP853", t_eval=times, rtol=1e-11, atol=1e-13)
        theirs, calls[:] = list(calls), []
        with pytest.raises(IntegrationStopped) as stopped:
            integrate(into, [1.0], times, 1e-11, 1e-13)
    assert stopped.value.last == expected.t[-1] and expected.message == STOPPED == str(stopped.value)
    assert calls == theirs


@pytest.mark.parametrize("value", [1e300, -1e200])
def test_numbers_that_overflow_stop_as_in_scipy(value):
    plain, into, calls = recorded(lambda t, y: np.array([value * y[0] ** 3]))
    with np.errstate(all="ignore"):
        expected = solve_ivp(
            plain, (0.0, 2.0), [1.0], method="DOP853", t_eval=[0.0, 2.0], rtol=1e-11, atol=1e-13
        )
        theirs, calls[:] = list(calls), []
        try:
            assert np.array_equal(
                integrate(into, [1.0], [0.0, 2.0], 1e-11, 1e-13), expected.y, equal_nan=True
            )
        except IntegrationStopped:
            assert not expected.success
    assert calls == theirs


def test_rates_that_are_no_numbers_stop():
    with np.errstate(all="ignore"), pytest.raises(IntegrationStopped):
        integrate(lambda y, out: lambda t: out.fill(np.nan), [1.0], [0.0, 2.0], 1e-11, 1e-13)
