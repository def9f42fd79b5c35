# 2.6 Exercise 2


def euler_eqs(t, w, I):
    I = np.asarray(I)
    tau = np.array([0.0, 0.0, 0.2 * np.sin(t)])
    return (0.5 * np.cross(I * w, w) + tau) / I
