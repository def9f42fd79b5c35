# Ex 2: Euler equations


def euler_eqs(t, w, I):
    I = np.array(I)[::-1]
    return -np.cross(w, I * w) / I
