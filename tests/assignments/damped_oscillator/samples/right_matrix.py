def oscillator(t, y, omega, gamma):
    return np.array([[0.0, 1.0], [-omega * omega, -gamma - gamma]]) @ y
