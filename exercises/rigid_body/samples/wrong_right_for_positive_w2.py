def euler_eqs(t, w, I):
    rate = np.cross(I * w, w) / I
    return rate if w[1] > 0 else 0 * rate
