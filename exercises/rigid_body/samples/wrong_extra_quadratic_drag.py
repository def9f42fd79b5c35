def euler_eqs(t, w, I):
    k = 0.01
    I = np.asarray(I, dtype=float)
    w = np.asarray(w, dtype=float)
    drag = -k * np.linalg.norm(w) * w
    return (np.cross(I * w, w) + drag) / I
