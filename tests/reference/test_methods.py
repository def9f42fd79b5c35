"""Every method against the exact solution: its order, what it conserves, and that importing reference costs
no compiler.
"""

import subprocess
import sys

import numpy as np
import pytest

from reference import Exact, kinetic_energy, momentum_norm, orthonormality_error
from reference.errors import exact_run
from reference.methods import HEAVY, METHODS, Scene
from reference.methods.splitting import KAHAN_LI_6, KAHAN_LI_8, SUZUKI4

SCENE = Scene("test", (1.0, 0.6, 0.8), (2.0, 3.0, 4.0), 8.0, intervals=8)
EXACT = Exact(SCENE.w0, SCENE.I).sample(SCENE.t, orientation=True)
# Steps per interval of one second at which each order shows: coarser for the high ones, which reach rounding
# soon.
ASYMPTOTIC = {1: (512, 1024), 2: (32, 64), 4: (32, 64), 6: (4, 8), 8: (4, 8), 12: (4, 6)}
BY_NAME = {m.name: m for m in METHODS}


def error(method, setting, scene=SCENE, exact=EXACT):
    run = method.run(scene, setting)
    assert (
        run.w.shape == (3, scene.intervals + 1)
        and run.R.shape == (scene.intervals + 1, 3, 3)
        and run.calls >= 1
    )
    return max(np.abs(run.w - exact.w).max(), np.abs(run.R - exact.R).max())


def compiled(names):
    """Parameters: numba compiles each family for seconds, so ``make test`` has the explicit methods alone."""
    return [
        name if BY_NAME[name].line == "explicit" else pytest.param(name, marks=pytest.mark.slow)
        for name in names
    ]


@pytest.mark.parametrize("name", compiled(m.name for m in METHODS if m.order))
def test_observed_order(name):
    method = BY_NAME[name]
    scene, exact = SCENE, EXACT
    coarse, fine = ASYMPTOTIC[method.order]
    if method.order == 12:
        scene = Scene("test", SCENE.w0, SCENE.I, 16.0, intervals=4)
        exact = Exact(scene.w0, scene.I).sample(scene.t, orientation=True)
    if method.line == "Lie group":
        coarse, fine = 128, 256
    gain = error(method, coarse, scene, exact) / error(method, fine, scene, exact)
    observed = np.log(gain) / np.log(fine / coarse)
    assert abs(observed - method.order) <= 0.15


@pytest.mark.slow
@pytest.mark.parametrize("method", [m for m in HEAVY if m.order], ids=lambda m: m.name)
def test_observed_order_on_the_heavy_top(method):
    scene = Scene("test", (0.3, 0.6, 9.0), (1.0, 1.0, 0.6), 2.0, intervals=8, mgl=10.0, tilt=0.6)
    coarse, fine = (32, 64) if method.order < 6 else (8, 16)
    gain = error(method, coarse, scene, exact_run(scene)) / error(method, fine, scene, exact_run(scene))
    assert abs(np.log2(gain) - method.order) <= 0.15


@pytest.mark.parametrize("method", [m for m in HEAVY if m.line == "adaptive"], ids=lambda m: m.name)
def test_adaptive_methods_follow_their_tolerance_on_the_heavy_top(method):
    scene = Scene("test", (0.3, 0.6, 9.0), (1.0, 1.0, 0.6), 2.0, intervals=8, mgl=10.0, tilt=0.6)
    errors = [error(method, rtol, scene, exact_run(scene)) for rtol in method.settings]
    assert errors[-1] < 1e-9 and errors[-1] < errors[0] / 1e3


@pytest.mark.parametrize("name", [m.name for m in METHODS if m.order is None and m.line != "closed form"])
def test_adaptive_methods_follow_their_tolerance(name):
    errors = [error(BY_NAME[name], rtol) for rtol in BY_NAME[name].settings]
    assert len(errors) >= 6 and errors[-1] < 1e-6 and errors[-1] < errors[0] / 1e3


@pytest.mark.parametrize(
    "name",
    compiled(
        ["Gauss 4", "Gauss 12", "Strang splitting", "splitting 8", "Moser-Veselov 2", "Moser-Veselov 6"]
    ),
)
def test_geometric_methods_conserve_what_they_should_over_a_long_run(name):
    scene = Scene("long", (1.0, 0.6, 0.8), (2.0, 3.0, 4.0), 1800.0, intervals=100)
    run = BY_NAME[name].run(scene, 180)
    assert np.ptp(momentum_norm(run.w, scene.I)) < 1e-11
    assert orthonormality_error(run.R).max() < 1e-10
    drift = np.ptp(kinetic_energy(run.w, scene.I))
    assert drift < (2e-2 if name == "Strang splitting" else 1e-9)


def test_compositions_are_symmetric_and_add_up_to_one_step():
    for gammas in (SUZUKI4, KAHAN_LI_6, KAHAN_LI_8):
        assert abs(gammas.sum() - 1) < 1e-15 and (gammas == gammas[::-1]).all()


def test_there_are_enough_methods_and_settings_for_a_chart():
    assert len(METHODS) >= 14 and all(len(m.settings) >= 6 for m in METHODS if m.line != "closed form")


def test_importing_reference_imports_no_compiler():
    script = "import reference, sys; sys.exit('numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == 0
