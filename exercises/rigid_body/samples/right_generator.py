def components(w, I):
    w, I = list(w), list(I)
    for _ in range(3):
        yield (I[1] - I[2]) * w[1] * w[2] / I[0]
        w.append(w.pop(0))      # cyclic permutation 1 -> 2 -> 3 -> 1
        I.append(I.pop(0))


def euler_eqs(t, w, I):
    return [*components(w, I)]
