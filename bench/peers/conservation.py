"""The two checks that the course notebook prints in exercise 2, spelled once; each peer puts them into its own form of test.

They use the submission's own ``integrate_body``, ``T_rot`` and ``L_body``, as the notebook does, and the motion and the limit that
polhode's checks have.
"""

from exercises.catalogue import assignments

_EXERCISE = assignments()["rigid-body"]
_MOTION = _EXERCISE.scene("torque-free").inputs
LIMIT = 1e-6
COMMON = f"""import numpy as np

w0, body = {tuple(_MOTION["w0"])}, np.array({_MOTION["I"]})
t = np.linspace(0.0, {_MOTION["t_end"]}, {_MOTION["n"]})


def drift(series):
    return np.max(np.abs(series - series[0])) / abs(series[0])
"""
ENERGY = f"drift(T_rot(w, body)) < {LIMIT}"
MOMENTUM = f"drift(np.linalg.norm(L_body(w, body), axis=0)) < {LIMIT}"
INTEGRATE = "w, _ = integrate_body(euler_eqs, w0, body, t)"
