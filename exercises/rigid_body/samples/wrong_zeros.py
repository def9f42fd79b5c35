def euler_eqs(t, w, I):
    return np.zeros(3)
