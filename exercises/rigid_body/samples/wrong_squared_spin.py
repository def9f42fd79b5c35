def euler_eqs(t, w, I):
    w = w**2
    return np.cross(I * w, w) / I
