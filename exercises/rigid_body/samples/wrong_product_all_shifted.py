def euler_eqs(t, w, I):
    out = np.zeros(3)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        out[i] = (I[j] - I[k]) * w[i] * w[j] / I[i]
    return out
