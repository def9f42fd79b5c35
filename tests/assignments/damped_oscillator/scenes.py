"""The scenes: which function is called with which inputs, what it returns, and the exact answer."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from exercises.authoring.assignments.assignment import ArraySpec, Inputs, Scene

from . import truth
from .public.parameters import DAMPED, START, T_END, UNDAMPED, N

Array = NDArray[np.float64]

PROBES = 32


def _probes(rng: np.random.Generator) -> Inputs:
    """Draw random arguments, one call per row, with γ < ω."""
    omega = rng.uniform(0.5, 4.0, PROBES)
    y = rng.uniform(-2.0, 2.0, (PROBES, 2))
    return {
        "t": rng.uniform(0.0, 20.0, PROBES),
        "y": y,
        "omega": omega,
        "gamma": omega * rng.uniform(0.05, 0.9, PROBES),
    }


def _exact_rates(inputs: Inputs) -> Mapping[str, Array]:
    """Return the exact rates, and the size of the summed terms, to which rounding errors are relative."""
    y, omega, gamma = (np.asarray(inputs[name]) for name in ("y", "omega", "gamma"))
    summed = omega**2 * np.abs(y[:, 0]) + 2 * gamma * np.abs(y[:, 1])
    return {"rate": truth.rates(y, omega, gamma), "scale": np.column_stack([np.abs(y[:, 1]), summed])}


def _motion(name: str, omega: float, gamma: float) -> Scene:
    inputs = {"y0": list(START), "omega": omega, "gamma": gamma, "t_end": T_END, "n": N}
    return Scene(
        name,
        "motion",
        "oscillator",
        inputs,
        {"y": ArraySpec((2, N))},
        _exact_motion,
        5.0,
        after="probes",
        known=("t",),
    )


def _exact_motion(inputs: Inputs) -> Mapping[str, Array]:
    t = np.linspace(0.0, inputs["t_end"], inputs["n"])
    return {"t": t, "y": truth.motion(t, inputs["y0"], inputs["omega"], inputs["gamma"])}


SCENES = (
    Scene(
        "probes",
        "rates",
        "oscillator",
        _probes,
        {"rate": ArraySpec((PROBES, 2))},
        _exact_rates,
        2.0,
    ),
    _motion("damped", *DAMPED),
    _motion("undamped", *UNDAMPED),
)
