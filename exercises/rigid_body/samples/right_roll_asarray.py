def euler_eqs(t, w, I):
    I = np.asarray(I, dtype=float)
    w = np.asarray(w, dtype=float)
    dI = np.roll(I, -1) - np.roll(I, -2)
    ww = np.roll(w, -1) * np.roll(w, -2)
    return dI * ww / I
