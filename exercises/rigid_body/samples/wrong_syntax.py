def euler_eqs(t, w, I)
    return w
