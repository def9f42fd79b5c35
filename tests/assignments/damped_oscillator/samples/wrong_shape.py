def oscillator(t, y, omega, gamma):
    x, v = y
    return [[v], [-(omega**2) * x - 2 * gamma * v]]
