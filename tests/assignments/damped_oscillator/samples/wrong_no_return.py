def oscillator(t, y, omega, gamma):
    x, v = y
    np.array([v, -(omega**2) * x - 2 * gamma * v])
