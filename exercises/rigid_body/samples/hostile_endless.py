def euler_eqs(t, w, I):
    while True:
        pass
