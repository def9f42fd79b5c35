class EulerEquations:
    def __init__(self):
        self.cache = {}

    def coefficients(self, I):
        key = tuple(float(x) for x in I)
        if key not in self.cache:
            a, b, c = key
            self.cache[key] = ((b - c) / a, (c - a) / b, (a - b) / c)
        return self.cache[key]

    def __call__(self, t, w, I):
        p, q, r = self.coefficients(I)
        return np.array([p * w[1] * w[2], q * w[2] * w[0], r * w[0] * w[1]])


euler_eqs = EulerEquations()
