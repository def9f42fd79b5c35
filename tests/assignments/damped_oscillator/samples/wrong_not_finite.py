def oscillator(t, y, omega, gamma):
    x, v = y
    return [v, np.sqrt(-1.0 - x**2)]
