def euler_eqs(t, w, I):
    def rate(w):
        return np.cross(I * w, w) / I

    h = 1e-4
    return (rate(w) + rate(w + h * rate(w))) / 2
