"""Every method against the exact solution: its order, what it conserves, and that importing reference costs
no compiler.
"""

import subprocess
import sys

import numpy as np
import pytest

from reference import kinetic_energy, momentum_norm, orthonormality_error
from reference.charts.deviations import errors, exact_run
from reference.methods import HEAVY, METHODS, Scene
from reference.methods.runge_kutta import RK4, TOLERANCES, adaptive, fixed, in_scipy
from reference.methods.splitting import KAHAN_LI_6
from reference.methods.states import ANGLES, MATRIX, QUATERNION

SCENE = Scene("test", (1.0, 0.6, 0.8), (2.0, 3.0, 4.0), 8.0, intervals=8)
TOP = Scene("test", (0.3, 0.6, 9.0), (1.0, 1.0, 0.6), 2.0, intervals=8, mgl=10.0, tilt=0.6)
# Steps per interval at which each order shows: coarser for the high ones, which reach rounding soon.
ASYMPTOTIC = {1: (512, 1024), 2: (32, 64), 4: (32, 64), 6: (4, 8), 8: (4, 8)}
ON_TOP = {1: (4096, 8192), 2: (32, 64), 4: (32, 64), 6: (8, 16), 8: (2, 4)}
BY_NAME = {m.name: m for m in METHODS}
# numba compiles each family for seconds, so ``make test`` has the Runge-Kutta methods alone.
SLOWLY = ("Strang splitting", "splitting 6", "Moser-Veselov 6")


def error(scene, run):
    assert (
        run.w.shape == (3, scene.intervals + 1)
        and run.R.shape == (scene.intervals + 1, 3, 3)
        and run.calls >= 1
    )
    found = errors(scene, run, exact_run(scene))
    return max(found.w, found.R)


def compiled(names):
    """Parameters, of which the families that are not compiled anyway are slow."""
    return [pytest.param(name, marks=pytest.mark.slow) if name in SLOWLY else name for name in names]


def observed(method, scene, settings):
    coarse, fine = settings[method.order]
    gain = error(scene, method.run(scene, coarse)) / error(scene, method.run(scene, fine))
    return np.log(gain) / np.log(fine / coarse)


@pytest.mark.parametrize("name", compiled(m.name for m in METHODS if m.order))
def test_observed_order(name):
    assert abs(observed(BY_NAME[name], SCENE, ASYMPTOTIC) - BY_NAME[name].order) <= 0.15


@pytest.mark.parametrize("name", compiled(m.name for m in HEAVY if m.order))
def test_observed_order_on_the_heavy_top(name):
    assert abs(observed(BY_NAME[name], TOP, ON_TOP) - BY_NAME[name].order) <= 0.15


@pytest.mark.parametrize("form", [MATRIX, QUATERNION, ANGLES])
@pytest.mark.parametrize("scene", [SCENE, TOP], ids=["free", "torque"])
def test_each_form_of_the_attitude_is_of_order_four_and_the_same_motion(form, scene):
    scene = Scene(scene.name, scene.w0, scene.I, 1.0, 4, scene.mgl, tilt=0.6)
    coarse, fine = (error(scene, fixed(RK4, scene, steps, form)) for steps in (32, 64))
    assert fine < 1e-6 and abs(np.log2(coarse / fine) - 4) <= 0.2


@pytest.mark.parametrize("scene", [SCENE, TOP], ids=["free", "torque"])
@pytest.mark.parametrize("run", [adaptive, in_scipy])
def test_dop853_follows_its_tolerance_compiled_and_in_scipy(run, scene):
    found = [error(scene, run(scene, rtol)) for rtol in TOLERANCES]
    assert found[-1] < 1e-11 and all(e < 100 * rtol for e, rtol in zip(found, TOLERANCES, strict=True))


def test_the_compiled_dop853_takes_as_many_calls_as_scipys():
    scene = Scene("test", SCENE.w0, SCENE.I, 20.0, 40)
    for rtol in (1e-9, 1e-11):
        assert adaptive(scene, rtol).calls == pytest.approx(in_scipy(scene, rtol).calls, rel=0.15)


def test_a_step_that_never_suffices_ends_in_no_number():
    scene = Scene("test", (1e9, 1e9, 1.0), SCENE.I, 1.0, 2)
    run = adaptive(scene, 1e-13)
    assert np.isnan(run.w[:, -1]).all() and np.isinf(errors(scene, run).w)


def test_making_a_matrix_orthonormal_again_costs_no_accuracy_and_gains_none():
    scene = Scene("test", SCENE.w0, SCENE.I, 40.0, 40)
    plain, tidy = (errors(scene, fixed(RK4, scene, 8, tidy=tidy)) for tidy in (False, True))
    assert tidy.orthonormality < 1e-12 < 1e-7 < plain.orthonormality
    assert pytest.approx(plain.R, rel=0.2) == tidy.R


def test_single_precision_is_computed_in_single_precision():
    single, double = (errors(SCENE, fixed(RK4, SCENE, 128, precision=p)).w for p in (np.float32, np.float64))
    assert 1e-8 < single < 1e-4 and double < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("name", SLOWLY)
def test_geometric_methods_conserve_what_they_should_over_a_long_run(name):
    scene = Scene("long", (1.0, 0.6, 0.8), (2.0, 3.0, 4.0), 1800.0, intervals=100)
    run = BY_NAME[name].run(scene, 180)
    assert np.ptp(momentum_norm(run.w, scene.I)) < 1e-11
    assert orthonormality_error(run.R).max() < 1e-10
    drift = np.ptp(kinetic_energy(run.w, scene.I))
    assert drift < (2e-2 if name == "Strang splitting" else 1e-9)


def test_the_composition_is_symmetric_and_adds_up_to_one_step():
    assert abs(KAHAN_LI_6.sum() - 1) < 1e-15 and (KAHAN_LI_6[::-1] == KAHAN_LI_6).all()


def test_importing_reference_imports_no_compiler():
    script = "import reference, sys; sys.exit('numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == 0
