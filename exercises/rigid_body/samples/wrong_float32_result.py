def euler_eqs(t, w, I):
    out = np.zeros(3, dtype=np.float32)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        out[i] = (I[j] - I[k]) * w[j] * w[k] / I[i]
    return out
