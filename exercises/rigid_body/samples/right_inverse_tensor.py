def euler_eqs(t, w, I):
    """I w' + w x (I w) = 0   ->   w' = I^-1 ((I w) x w)"""
    inertia = np.eye(3) * np.asarray(I, dtype=float)
    inverse = np.eye(3) / np.asarray(I, dtype=float)
    L = inertia.dot(w)
    return inverse.dot(np.cross(L, w))
