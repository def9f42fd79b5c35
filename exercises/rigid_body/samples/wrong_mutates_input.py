def euler_eqs(t, w, I):
    rates = -np.cross(w, I * w) / I
    w *= 0.5
    return rates
