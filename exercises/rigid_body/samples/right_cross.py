def euler_eqs(t, w, I):
    I = np.asarray(I)
    return -np.cross(w, I * w) / I
