# Exercise 2, torque-free rigid body


def euler_eqs(t, w, I):
    L = np.diag(I) @ w
    return -np.cross(w, L)
