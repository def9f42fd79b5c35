def euler_eqs(t, w, I):
    w = np.array(w, dtype="float32")
    I = np.array(I, dtype="float32")
    wdot = -np.cross(w, I * w) / I
    return wdot.astype(float)
