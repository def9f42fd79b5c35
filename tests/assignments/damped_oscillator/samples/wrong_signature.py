def oscillator(y, t):
    x, v = y
    return [v, -4.0 * x - 0.2 * v]
