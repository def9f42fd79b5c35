# Ex 2: Euler equations


def euler_eqs(t, w, I):
    J = np.diag(I)
    L = J @ w
    return np.linalg.solve(J, -np.cross(w, L))
