def euler_eqs(t, w, I):
    res = np.empty(3)
    for i in range(3):
        j = (i + 1) % 3
        k = (i + 2) % 3
        res[i] = (I[j] - I[k]) * w[j] * w[k] / I[i]
    return res
