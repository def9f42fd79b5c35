def skew(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def euler_eqs(t, w, I):
    tensor = np.diag(I)
    return np.linalg.inv(tensor) @ (-skew(w) @ tensor @ w)
