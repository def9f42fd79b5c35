from scipy.linalg import solve


def hat(v):
    x, y, z = v
    return np.array([[0, -z, y],
                     [z, 0, -x],
                     [-y, x, 0]])


def euler_eqs(t, w, I):
    # coadjoint action: J w' = ad*_w (J w) = - hat(w) J w
    J = np.diag(I)
    return solve(J, -hat(w) @ J @ w, assume_a="pos")
