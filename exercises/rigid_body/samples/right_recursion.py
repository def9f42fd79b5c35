def rates(w, I, n):
    if n == 0:
        return []
    first = (I[1] - I[2]) * w[1] * w[2] / I[0]
    # turn the axes 1 -> 2 -> 3 -> 1 and do it again
    return [first] + rates([w[1], w[2], w[0]], [I[1], I[2], I[0]], n - 1)


def euler_eqs(t, w, I):
    return np.array(rates(list(w), list(I), 3))
