def oscillator(t, y, omega, gamma):
    while True:
        pass
