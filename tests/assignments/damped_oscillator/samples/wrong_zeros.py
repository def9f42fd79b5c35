def oscillator(t, y, omega, gamma):
    return np.zeros(2)
