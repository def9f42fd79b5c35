def oscillator(t, y, omega, gamma):
    x, v = y
    return [v, -omega * x - 2 * gamma * v]
