def euler_eqs(t, w, I):
    J = np.diag(I)
    L = J @ np.asarray(w)
    torque = np.cross(L, w).reshape(3, 1)
    return np.linalg.inv(J) @ torque
