"""The calls of a student's functions."""

import numpy as np

from polhode.judging.return_value import real_array


def values(student, inputs):
    """Return ``y``, the model at x (n,)."""
    return {"y": real_array(student["model"](np.array(inputs["x"])), (len(inputs["x"]),), "model")}


def misfit(student, inputs):
    """Return what residual makes of the student's own model at x (n,) and y (n,)."""
    predicted = student["model"](np.array(inputs["x"]))
    return {"value": real_array(student["residual"](predicted, np.array(inputs["y"])), (), "residual")}


def total(student, inputs):
    """Return what total reads from the data files."""
    return {"value": real_array(student["total"](), (), "total")}


def variable(student, inputs):
    """Return the variable slope."""
    return {"value": real_array(student["slope"], (), "slope")}


def entry(student, inputs):
    """Return the entry ``key`` of the dict settings."""
    return {"value": real_array(student["settings"][inputs["key"]], (), "settings")}


def steps(student, inputs):
    """Return the count of a pendulum after n steps."""
    pendulum = student["Pendulum"]()
    for _ in range(inputs["n"]):
        pendulum.step()
    return {"value": real_array(pendulum.count, (), "Pendulum.count")}
