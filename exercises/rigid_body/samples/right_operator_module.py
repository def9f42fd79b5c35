from operator import itemgetter, mul, sub, truediv

forward, backward = itemgetter(1, 2, 0), itemgetter(2, 0, 1)


def euler_eqs(t, w, I):
    gap = map(sub, forward(I), backward(I))
    pair = map(mul, forward(w), backward(w))
    return np.array(list(map(truediv, map(mul, gap, pair), I)))
