NEXT = np.array([1, 2, 0])
PREV = [2, 0, 1]
DIM = 3


def euler_eqs(t, w, I):
    w, I = np.asarray(w), np.asarray(I)
    assert len(w) == DIM
    return (I[NEXT] - I[PREV]) / I * w[NEXT] * w[PREV]
