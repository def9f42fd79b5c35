TORQUE = np.array([0.0, 0.0, 0.1])


def euler_eqs(t, w, I):
    I = np.asarray(I, dtype=float)
    return (TORQUE - np.cross(w, I * w)) / I
