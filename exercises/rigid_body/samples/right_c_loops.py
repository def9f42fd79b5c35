N = 3


def euler_eqs(t, w, I):
    out = [0.0] * N
    i = 0
    while i < N:
        j = (i + 1) % N
        k = (j + 1) % N
        out[i] = (I[j] - I[k]) * w[j] * w[k]
        out[i] /= I[i]
        i += 1
    return out
