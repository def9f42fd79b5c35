def euler_eqs(t, w, I):
    return w * np.abs(w) ** 1.5
