def euler_eqs(t, w, I):
    wdot = np.zeros(3)
    for i in range(2):
        j, k = (i + 1) % 3, (i + 2) % 3
        wdot[i] = (I[j] - I[k]) * w[j] * w[k] / I[i]
    return wdot
