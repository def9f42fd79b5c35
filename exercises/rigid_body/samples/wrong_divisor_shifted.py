def euler_eqs(t, w, I):
    res = []
    for i, j, k in [(0, 1, 2), (1, 2, 0), (2, 0, 1)]:
        res.append((I[j] - I[k]) * w[j] * w[k] / I[j])
    return np.array(res)
