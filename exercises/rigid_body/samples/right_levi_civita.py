eps = np.zeros((3, 3, 3))
for i in range(3):
    for j in range(3):
        for k in range(3):
            eps[i, j, k] = (i - j) * (j - k) * (k - i) / 2


def euler_eqs(t, w, I):
    # I_ij dw_j/dt = - eps_ijk w_j I_kl w_l
    Iij = np.diag(I).astype(float)
    torque = -np.einsum("ijk,j,kl,l->i", eps, w, Iij, w)
    return np.einsum("ij,j->i", np.linalg.inv(Iij), torque)
