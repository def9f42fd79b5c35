class EulerEquations:
    """Behaves like a function but also counts how often the solver calls it."""

    def __init__(self):
        self.calls = 0

    def __call__(self, t, w, I):
        self.calls += 1
        return np.array([self.component(i, w, I) for i in range(3)])

    @staticmethod
    def component(i, w, I):
        j, k = (i + 1) % 3, (i + 2) % 3
        return w[j] * w[k] * (I[j] - I[k]) / I[i]


euler_eqs = EulerEquations()

if __name__ == "__main__":
    w, R = integrate_body(euler_eqs, [1.0, 0.6, 0.8], np.array([2.0, 3.0, 4.0]), np.linspace(0, 5, 50))
    print("rhs evaluations:", euler_eqs.calls)
