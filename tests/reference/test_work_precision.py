from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from reference.methods import METHODS, Scene
from reference.work_precision import SCENES, measure, rows

BY_NAME = {m.name: m for m in METHODS}


@pytest.mark.slow
def test_points_tell_error_over_the_whole_run_cost_and_invariants():
    chosen = [BY_NAME[n] for n in ("RK4", "Euler", "exact", "DOP853")]
    points = list(measure([SCENES[4]], chosen, repeats=1))
    assert len(points) == sum(len(m.settings) for m in chosen)
    rk4 = [p for p in points if p.method == "RK4"]
    assert all(a.error_R > 10 * b.error_R and a.calls < b.calls for a, b in pairwise(rk4[1:]))
    (exact,) = (p for p in points if p.method == "exact")
    assert max(exact.error_w, exact.error_R) < 1e-14 and exact.orthonormality < 1.5e-15 and exact.calls == 1
    yardstick = next(p for p in points if p.method == "DOP853" and p.setting == 1e-11)
    assert 0.2 < yardstick.ratio < 5 and all(p.seconds > 0 for p in points)
    assert rows(points)[0]["scene"] == "exercise 6"


@pytest.mark.slow
def test_a_heavy_top_has_methods_and_invariants_of_its_own():
    scene = next(s for s in SCENES if s.name == "heavy top")
    points = list(measure([replace(scene, t_end=0.4, intervals=4)], repeats=1))
    assert {"DOP853", "Euler angles (DOP853)", "splitting 6", "exact"} <= {p.method for p in points}
    splitting = [p for p in points if p.method == "splitting 4"]
    assert splitting[-1].error_R < 1e-9 < splitting[0].error_R and splitting[0].orthonormality < 1e-14
    assert all(p.momentum < 1e-13 for p in splitting) and splitting[-1].energy < 1e-9 < splitting[0].energy


@pytest.mark.slow
def test_a_blow_up_has_infinite_error_and_no_number():
    long = Scene("long", (1.0, 0.6, 0.8), (2.0, 3.0, 4.0), 2000.0)
    coarsest = replace(BY_NAME["Euler"], settings=BY_NAME["Euler"].settings[:1])
    points = list(measure([long], [coarsest], repeats=1))
    assert np.isinf(points[0].error_R) and np.isinf(points[0].energy)


def test_scenes_are_those_of_the_notebook_and_two_where_methods_fail():
    assert len(SCENES) >= 6 and {"exercise 2", "exercise 6", "separatrix, nudge 1e-8"} <= {
        s.name for s in SCENES
    }
