def euler_eqs(t, w, I):
    I = np.asarray(I)
    return np.cross(I * w, w) / np.linalg.norm(I)
