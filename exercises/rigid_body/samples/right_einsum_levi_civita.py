eps = np.zeros((3, 3, 3))
for i, j, k in [(0, 1, 2), (1, 2, 0), (2, 0, 1)]:
    eps[i, j, k] = 1
    eps[i, k, j] = -1


def euler_eqs(t, w, I):
    I = np.array(I, dtype=float)
    # dw_i = -eps_ijk w_j I_k w_k / I_i
    return -np.einsum("ijk,j,k->i", eps, w, I * w) / I
