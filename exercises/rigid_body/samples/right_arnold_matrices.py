# Arnold's form for so(n): M = J W + W J,  dM/dt = [M, W]
# with J the second-moment matrix, I = tr(J) - J.

def euler_eqs(t, w, I):
    I1, I2, I3 = I
    J = np.array([(I2 + I3 - I1) / 2, (I3 + I1 - I2) / 2, (I1 + I2 - I3) / 2])
    W = np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
    S = J[:, None] + J[None, :]          # S_ij = J_i + J_j, i.e. the third moment
    M = S * W
    dW = (M @ W - W @ M) / S
    return np.array([dW[2, 1], dW[0, 2], dW[1, 0]])
