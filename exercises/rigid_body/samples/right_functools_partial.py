from functools import partial


def rigid_body(torque, t, w, I):
    I = np.asarray(I)
    return (torque - np.cross(w, I * w)) / I


euler_eqs = partial(rigid_body, np.zeros(3))
