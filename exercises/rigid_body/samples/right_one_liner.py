euler_eqs = lambda t, w, I: np.cross(np.multiply(I, w), w) / I
