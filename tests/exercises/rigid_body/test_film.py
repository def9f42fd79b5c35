"""The motion that animations are asked to show."""

import numpy as np

import reference
from exercises.rigid_body.assignment import TILT
from service.grading.jobs import truth


def test_the_film_starts_away_from_every_axis_and_plane(rigid_body):
    scene = rigid_body.scene("film")
    given = truth(scene, scene.inputs)
    axis, unit = given["R"][:, :, 2], given["L"] / np.linalg.norm(given["L"])
    assert np.abs(unit).min() > 0.1 and np.abs(axis[0]).min() > 0.1
    assert axis.min(axis=0).max() < -0.1 and axis.max(axis=0).min() > 0.1, "it crosses each coordinate plane"
    exact = reference.motion((2.2, 0.0, 0.5), (1.25, 1.25, 2.0), given["t"], need="orientation").R
    assert np.allclose(given["R"], TILT @ exact)
