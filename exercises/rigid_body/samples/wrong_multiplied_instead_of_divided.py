# Exercise 2, torque-free rigid body


def euler_eqs(t, w, I):
    J = np.diag(I)
    return J @ np.cross(J @ w, w)
