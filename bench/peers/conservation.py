"""The two checks that the course notebook prints in exercise 2, shared by all peers.

They use the submission's ``integrate_body``, ``T_rot`` and ``L_body``, as the notebook does, with the motion
and the limit of polhode's checks.
"""

from exercises.authoring.assignments.catalogue import find

_EXERCISE = find("rigid-body")
_MOTION = _EXERCISE.scene("torque-free").inputs
LIMIT = 1e-6
COMMON = f"""import numpy as np

w0, body = {tuple(_MOTION["w"])}, np.array({_MOTION["I"]})
t = np.linspace(0.0, {_MOTION["until"]}, {_MOTION["samples"]})


def drift(series):
    return np.max(np.abs(series - series[0])) / abs(series[0])
"""
ENERGY = f"drift(T_rot(w, body)) < {LIMIT}"
MOMENTUM = f"drift(np.linalg.norm(L_body(w, body), axis=0)) < {LIMIT}"
INTEGRATE = "w, _ = integrate_body(euler_eqs, w0, body, t)"
